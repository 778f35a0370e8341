// ModelRoot: one model as something rays can be traced into, in the model's own frame.
#pragma once

#include "geometry/accel/expansion_counts.h"
#include "geometry/accel/surface_patch.h"

namespace meristem {

// The state of one ray, handed through Embree's callbacks. Embree sees only the first member.
struct RayContext {
  RTCIntersectContext embree;
  const SurfacePatch* patch = nullptr;  // what the nearest hit so far lies on
  Key patch_key = 0;                    // of its cell: decides ties
  int patch_object = -1;
  int object = -1;                  // being traced
  std::uint32_t* visits = nullptr;  // of a sampled ray: counts of the cells it meets, by class
};

class ModelRoot {
 public:
  virtual ~ModelRoot() = default;
  virtual void intersect(RayContext& context, RTCRayHit& ray) const = 0;
  virtual void occluded(RayContext& context, RTCRay& ray) const = 0;
  const Bounds3f& bounds() const { return bounds_; }

 protected:
  explicit ModelRoot(const Bounds3f& bounds) : bounds_(bounds) {}

 private:
  Bounds3f bounds_;
};

// Traces a patch for a ray that may have a hit already; of two hits at one distance the smaller key wins.
void intersect_patch(const SurfacePatch& patch, Key key, RayContext& context, RTCRayHit& ray);

// Cells behind a cache. The cache and the counts outlive the root.
std::unique_ptr<ModelRoot> make_lazy_root(std::shared_ptr<const Model> model, GeometryCache& cache,
                                          ExpansionCounts& counts);
// Expands every cell of a lazy root, on `threads` threads.
void expand_everything(const ModelRoot& lazy_root, int threads);
// The whole final mesh as one patch.
std::unique_ptr<ModelRoot> make_flat_root(std::shared_ptr<const Model> model, ExpansionCounts& counts, int threads);

}  // namespace meristem
