// Instances: roots placed by transforms, behind an Embree scene of user geometry with their bounds. The world's objects
// and what a group or a placer puts into a cell are both this; it nests without limit (Debian's Embree has one level of
// instances of its own).
#pragma once

#include "geometry/accel/model_root.h"
#include "geometry/base/transform.h"

#include <memory>
#include <vector>

namespace meristem {

class Instance {
 public:
  // The root must outlive it. `path` tells apart what is reached through different instances; `object`: its index in
  // the world, or -1 within an object.
  Instance(const ModelRoot& root, const Bounds3f& root_bounds, const Affine3d& to_parent, Key path, int object = -1);

  void intersect(RayContext& context, RTCRayHit& ray) const;
  void occluded(RayContext& context, RTCRay& ray) const;
  bool follow(MissingCells::Way way, RayContext& context, RTCRayHit& ray) const;  // as ModelRoot::follow()
  const Bounds3f& bounds() const { return bounds_; }                              // in the parent's frame
  const ModelRoot& root() const { return *root_; }
  bool is_identity() const { return is_identity_; }

 private:
  template <class Trace>
  void with_local_ray(RayContext& context, RTCRayHit& ray, const Trace& trace) const;

  const ModelRoot* root_;
  Affine3f to_parent_, from_parent_;
  Bounds3f bounds_;
  Key path_;
  int object_;
  bool is_identity_;
};

class Instances {
 public:
  // Builds on the calling thread; call inside run_isolated(). `owned`: roots of which nobody else takes care.
  Instances(std::vector<Instance> instances, std::vector<std::unique_ptr<ModelRoot>> owned);

  void intersect(RayContext& context, RTCRayHit& ray) const;
  void occluded(RayContext& context, RTCRay& ray) const;
  // As ModelRoot::follow(); the way begins with the number of an instance.
  bool follow(MissingCells::Way way, RayContext& context, RTCRayHit& ray) const;
  const Bounds3f& bounds() const { return bounds_; }
  const std::vector<Instance>& list() const { return instances_; }
  std::size_t bytes() const { return bytes_; }

 private:
  std::vector<Instance> instances_;
  std::vector<std::unique_ptr<ModelRoot>> owned_;
  Bounds3f bounds_;
  ScenePtr scene_;
  std::size_t bytes_ = 0;
};

}  // namespace meristem
