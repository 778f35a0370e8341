// ClassWorlds: the objects of the world, once for each level of detail that a class of rays wants to see.
//
// A ray that leaves a surface of one world and looks at another would meet the coarser version of what it has just
// left. So it goes a short way, some faces of the coarser world, through the world in which it begins, and on through
// that of its class: what is near is seen as fine as the surface itself.
#pragma once

#include "geometry/accel/braided_cells.h"
#include "geometry/accel/roots.h"
#include "geometry/accel/surface.h"

#include <array>

namespace meristem {

// The objects as some classes of rays see them.
struct ClassWorld {
  std::shared_ptr<const Footprint> footprint;
  std::unique_ptr<Instances> objects;
  std::unique_ptr<const BraidedCells> braided;  // for rays in streams, where objects are more than a list holds
};

// The way of one ray through one world or two; calls as those of Instances.
class RayRoute {
 public:
  explicit RayRoute(const ClassWorld& all) : near_(&all), far_(nullptr), split_(0) {}
  // Up to t = `split` through the first, from the next float on through the second.
  RayRoute(const ClassWorld& near, const ClassWorld& far, float split) : near_(&near), far_(&far), split_(split) {}

  void intersect(RayContext& context, RTCRayHit& ray) const;
  void occluded(RayContext& context, RTCRay& ray) const;
  // As ModelRoot::follow(). Where there are two worlds the way begins with the number of one: 0 or 1.
  bool follow(CellList::Way way, RayContext& context, RTCRayHit& ray) const;
  // The same in steps, for a ray that has no hit yet: into one world after the other.
  class Steps;

 private:
  template <class Trace>
  void trace_near(RayContext& context, RTCRayHit& ray, const Trace& trace) const;
  template <class Trace>
  void trace_far(RTCRay& ray, const Trace& trace) const;

  const ClassWorld* near_;
  const ClassWorld* far_;  // null: there is one
  float split_;
};

class RayRoute::Steps {
 public:
  explicit Steps(const RayRoute& route) : route_(route) {}
  // The world that the ray goes through next, between its tnear and tfar; null: it has arrived. `has_met`: anything.
  const ClassWorld* next(RTCRay& ray, bool has_met);
  bool is_last() const { return !route_.far_ || step_ > 1; }
  // The ray begins again where it began.
  void end(RTCRay& ray) const {
    if (step_ > 0) ray.tnear = begin_;
  }

 private:
  const RayRoute route_;
  int step_ = 0;
  float begin_ = 0, end_ = 0;  // of the ray
};

class ClassWorlds {
 public:
  // Places the objects by `roots`, which must outlive it; call inside run_isolated().
  ClassWorlds(const std::vector<Placement>& objects, const WorldOptions& options, Roots& roots);

  RayRoute route(const Ray& ray) const;
  bool empty() const { return worlds_[0].objects->empty(); }
  void tighten();  // as Instances::tighten()
  void braid();    // objects, after their roots
  void unbraid();
  Bounds3f bounds() const;                      // of all worlds
  std::vector<const ModelRoot*> roots() const;  // of all objects, of each world
  std::size_t bytes() const;

 private:
  const ClassWorld& world_of(RayClass c) const { return worlds_[worlds_of_[std::size_t(c)]]; }

  std::vector<ClassWorld> worlds_;                    // those that differ
  std::array<std::size_t, ray_classes> worlds_of_{};  // their indices, by class
};

}  // namespace meristem
