// Instances: roots placed by transforms, behind a scene of their bounds. The world's objects
// and what a group or a placer puts into a cell are both this; it nests without limit (Debian's Embree has one level of
// instances of its own).
#pragma once

#include "geometry/accel/box_scene.h"
#include "geometry/accel/model_root.h"
#include "geometry/base/motion.h"

#include <memory>
#include <span>
#include <vector>

namespace meristem {

// One of them, a cache line: woods have millions.
class alignas(64) Instance {
 public:
  // `roots`: one, or one for each of equally long moments while the shutter is open; they must outlive it. Where, and
  // how it moves, `placement` says.
  Instance(std::span<const ModelRoot* const> roots, const Placement& placement);

  // Which of several it is. `path` tells apart what is reached through different instances; `object`: its index in the
  // world, or -1 within an object.
  struct Place {
    Key path;
    int object;
  };
  class Visit;
  void intersect(const Place& place, RayContext& context, RTCRayHit& ray) const;
  void occluded(RayContext& context, RTCRay& ray) const;
  // As ModelRoot::follow().
  bool follow(CellList::Way way, const Place& place, RayContext& context, RTCRayHit& ray) const;
  void add_roots(std::vector<const ModelRoot*>& roots) const;  // of all moments
  // Its box in its parent's frame by what is known of its roots, at all times.
  Bounds3f known_bounds() const;
  std::size_t bytes_beside() const {
    return special_ ? sizeof(Special) + special_->later_roots.capacity() * sizeof(ModelRoot*) : 0;
  }

 private:
  // Of few.
  struct Special {
    bool is_identity;                           // at all times
    std::vector<const ModelRoot*> later_roots;  // of the moments after the first
    std::shared_ptr<const Motion> motion;       // null: it stands still
  };
  const ModelRoot& root_at(float time) const;
  bool is_identity() const { return special_ && special_->is_identity; }
  Affine3f from_parent_at(float time) const;

  // Of what does not move. The way back is its inverse, needed of the nearest hit alone.
  Affine3f from_parent_;
  const ModelRoot* root_;  // of the first moment
  std::unique_ptr<const Special> special_;
};
static_assert(sizeof(Instance) == 64);

// A ray inside an instance, while one lives; at its end the ray outside is as long as the one inside has become.
class Instance::Visit {
 public:
  Visit(const Instance& instance, const Place& place, RayContext& context, RTCRayHit& outside);
  ~Visit();
  Visit(const Visit&) = delete;
  Visit& operator=(const Visit&) = delete;

  const ModelRoot& root() const { return root_; }
  RTCRayHit& ray() { return tree_ ? inside_ : outside_; }  // in the instance's frame

 private:
  const ModelRoot& root_;
  RayContext& context_;
  RTCRayHit& outside_;
  const Key outer_path_;
  const TreeRay* const outer_tree_;
  Affine3f from_parent_;  // all of these unless it is the identity
  RayContext::Frame frame_{};
  RTCRayHit inside_;
  std::optional<TreeRay> tree_;
};

class Instances {
 public:
  // `bounds`: of each, in the frame in which they stand. Builds on the calling thread; call inside run_isolated().
  // `owned`: roots of which nobody else takes care. `are_objects`: of the world. `first`: the number of the first among
  // all that stand in the same cell.
  Instances(std::vector<Instance> instances, std::span<const Bounds3f> bounds,
            std::vector<std::unique_ptr<ModelRoot>> owned, bool are_objects, std::uint32_t first);
  Instances(const Instances&) = delete;  // its scene holds on to it
  Instances& operator=(const Instances&) = delete;

  void intersect(RayContext& context, RTCRayHit& ray) const;
  void occluded(RayContext& context, RTCRay& ray) const;
  // One of them alone.
  void intersect(std::uint32_t index, RayContext& context, RTCRayHit& ray) const;
  void occluded(std::uint32_t index, RayContext& context, RTCRay& ray) const;
  // As ModelRoot::follow(); the way begins with the number of an instance.
  bool follow(CellList::Way way, RayContext& context, RTCRayHit& ray) const;
  // Those that the ray enters, the nearest first; nothing if there are more than a list holds in all.
  std::optional<std::size_t> entered(const TreeRay& ray, float t_min, float t_max, FewBoxes::List& list) const;
  std::uint32_t count() const { return std::uint32_t(instances_.size()); }
  const Instance& instance(std::uint32_t index) const { return instances_[index]; }
  Instance::Place place_of(std::uint32_t index) const {
    return {Key(first_) + index + 1, are_objects_ ? int(index) : -1};
  }
  // Of all, as they were placed.
  const Bounds3f& bounds() const { return bounds_; }
  // Makes the boxes as close as the roots are known by now: those of whole models are wide until they have been
  // expanded. While nothing is traced; call inside run_isolated().
  void tighten();
  std::vector<Bounds3f> few_boxes() const;  // of each, if they are few
  bool empty() const { return instances_.empty(); }
  std::vector<const ModelRoot*> roots() const;  // of all, at all moments
  std::size_t bytes() const { return bytes_; }

 private:
  static void intersect_one(void* self, std::uint32_t index, RayContext& context, RTCRayHit& ray);
  static void occlude_one(void* self, std::uint32_t index, RayContext& context, RTCRay& ray);

  std::vector<Instance> instances_;
  std::vector<std::unique_ptr<ModelRoot>> owned_;
  Bounds3f bounds_;
  const bool are_objects_;
  const std::uint32_t first_;
  std::vector<Bounds3f> tightened_;  // the boxes of the scene, if not those with which it was placed
  std::unique_ptr<BoxScene> scene_;  // null: there is one instance at most
  std::size_t bytes_ = 0;
};

// Of one that is to be placed: of all its roots, at all times, in its parent's frame.
Bounds3f instance_bounds(std::span<const ModelRoot* const> roots, const Placement& placement);

}  // namespace meristem
