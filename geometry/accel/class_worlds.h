// ClassWorlds: the objects of the world, once for each level of detail that a class of rays wants to see.
//
// A ray that leaves a surface of one world and looks at another would meet the coarser version of what it has just
// left. So it goes a short way, some faces of the coarser world, through the world in which it begins, and on through
// that of its class: what is near is seen as fine as the surface itself.
#pragma once

#include "geometry/accel/roots.h"
#include "geometry/accel/surface.h"

#include <array>

namespace meristem {

// The way of one ray through one world or two; calls as those of Instances.
class RayRoute {
 public:
  explicit RayRoute(const Instances& all) : near_(&all), far_(nullptr), split_(0) {}
  // Up to t = `split` through the first, from the next float on through the second.
  RayRoute(const Instances& near, const Instances& far, float split) : near_(&near), far_(&far), split_(split) {}

  void intersect(RayContext& context, RTCRayHit& ray) const;
  void occluded(RayContext& context, RTCRay& ray) const;
  // As ModelRoot::follow(). Where there are two worlds the way begins with the number of one: 0 or 1.
  bool follow(CellList::Way way, RayContext& context, RTCRayHit& ray) const;
  // All that there is on the way; null: there are two worlds.
  const Instances* only() const { return far_ ? nullptr : near_; }

 private:
  template <class Trace>
  void trace_near(RayContext& context, RTCRayHit& ray, const Trace& trace) const;
  template <class Trace>
  void trace_far(RTCRay& ray, const Trace& trace) const;

  const Instances* near_;
  const Instances* far_;  // null: there is one world
  float split_;
};

class ClassWorlds {
 public:
  // Places the objects by `roots`, which must outlive it; call inside run_isolated().
  ClassWorlds(const std::vector<Placement>& objects, const WorldOptions& options, Roots& roots);

  RayRoute route(const Ray& ray) const;
  bool empty() const { return worlds_[0].objects->empty(); }
  void tighten();                               // as Instances::tighten()
  Bounds3f bounds() const;                      // of all worlds
  std::vector<const ModelRoot*> roots() const;  // of all objects, of each world
  std::size_t bytes() const;

 private:
  struct World {
    std::shared_ptr<const Footprint> footprint;
    std::unique_ptr<Instances> objects;
  };
  const World& world_of(RayClass c) const { return worlds_[worlds_of_[std::size_t(c)]]; }

  std::vector<World> worlds_;                         // those that differ
  std::array<std::size_t, ray_classes> worlds_of_{};  // their indices, by class
};

}  // namespace meristem
