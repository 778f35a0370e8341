// Instances: roots placed by transforms, behind a scene of their bounds. The world's objects
// and what a group or a placer puts into a cell are both this; it nests without limit (Debian's Embree has one level of
// instances of its own).
#pragma once

#include "geometry/accel/box_scene.h"
#include "geometry/accel/model_root.h"
#include "geometry/base/motion.h"

#include <memory>
#include <vector>

namespace meristem {

class Instance {
 public:
  // `roots`: one, or one for each of equally long moments while the shutter is open; they must outlive it. Where, and
  // how it moves, `placement` says. `path` tells apart what is reached through different instances; `object`: its index
  // in the world, or -1 within an object.
  Instance(std::vector<const ModelRoot*> roots, const Placement& placement, Key path, int object = -1);

  void intersect(RayContext& context, RTCRayHit& ray) const;
  void occluded(RayContext& context, RTCRay& ray) const;
  bool follow(CellList::Way way, RayContext& context, RTCRayHit& ray) const;  // as ModelRoot::follow()
  const Bounds3f& bounds() const { return bounds_; }                          // in the parent's frame
  void add_roots(std::vector<const ModelRoot*>& roots) const;                 // of all moments
  bool is_identity() const { return is_identity_; }
  std::size_t own_bytes() const {
    return change_ ? sizeof(Change) + change_->roots.capacity() * sizeof(ModelRoot*) : 0;
  }

 private:
  // Of one that changes while the shutter is open.
  struct Change {
    std::vector<const ModelRoot*> roots;
    std::shared_ptr<const Motion> motion;  // null: none
  };
  struct Maps {
    Affine3f to_parent, from_parent;
  };
  static Maps maps_of(const Affine3d& to_parent);
  template <class Trace>
  void with_local_ray(RayContext& context, RTCRayHit& ray, const Trace& trace) const;

  const ModelRoot& root_at(float time) const;
  bool moves() const { return change_ && change_->motion; }

  const ModelRoot* root_;  // of the first moment
  Maps maps_;              // of one that does not move
  Bounds3f bounds_;
  Key path_;
  int object_;
  bool is_identity_;                      // at all times
  std::unique_ptr<const Change> change_;  // null: it stays as it is
};

class Instances {
 public:
  // Builds on the calling thread; call inside run_isolated(). `owned`: roots of which nobody else takes care.
  Instances(std::vector<Instance> instances, std::vector<std::unique_ptr<ModelRoot>> owned);
  Instances(const Instances&) = delete;  // its scene holds on to it
  Instances& operator=(const Instances&) = delete;

  void intersect(RayContext& context, RTCRayHit& ray) const;
  void occluded(RayContext& context, RTCRay& ray) const;
  // As ModelRoot::follow(); the way begins with the number of an instance.
  bool follow(CellList::Way way, RayContext& context, RTCRayHit& ray) const;
  const Bounds3f& bounds() const { return bounds_; }
  const std::vector<Instance>& list() const { return instances_; }
  std::vector<const ModelRoot*> roots() const;  // of all, at all moments
  std::size_t bytes() const { return bytes_; }

 private:
  std::vector<Instance> instances_;
  std::vector<std::unique_ptr<ModelRoot>> owned_;
  Bounds3f bounds_;
  std::optional<BoxScene> scene_;  // none: there is one instance at most
  std::size_t bytes_ = 0;
};

}  // namespace meristem
