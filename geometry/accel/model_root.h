// ModelRoot: one model as something rays can be traced into, in the model's own frame.
#pragma once

#include "geometry/accel/embree_device.h"
#include "geometry/accel/expansion_counts.h"
#include "geometry/accel/ray_search.h"
#include "geometry/accel/surface_patch.h"
#include "geometry/base/transform.h"
#include "geometry/cells/part.h"
#include "geometry/cells/uv_readers.h"
#include "geometry/tree/ray_stream.h"

#include <optional>

namespace meristem {

// The state of one ray, handed through Embree's callbacks. Embree sees only the first member.
struct RayContext {
  RTCIntersectContext embree;
  const TreeRay* tree_ray = nullptr;  // the ray in the frame of what it is traced into
  // Of the nearest hit so far.
  bool has_hit = false;
  const SurfacePatch* patch = nullptr;  // null: one that a search has kept
  TreeHit patch_hit{0};
  Key patch_key = 0, patch_path = 0;  // of its cell, and the instances around it
  HitRank kept_rank{};                // of a hit that a search has kept
  int patch_object = -1;
  std::optional<Affine3d> patch_from_world;  // none: identity

  // Being traced: instances of instances, from the innermost on; callbacks nest, so the links lie on the stack.
  struct Frame {
    const Affine3f* from_parent;
    const Frame* parent;
  };
  const Frame* frame = nullptr;
  Key path = 0;
  int object = -1;
  RayUse use;
  std::uint32_t* visits = nullptr;  // of a sampled ray: counts of the cells it meets, by class
  std::uint32_t acquired = 0;       // cells that were asked for
  bool only_resident = false;       // cells that are not resident are passed by
  bool has_passed_by = false;       // one was

  // Of a ray that expands nothing but what it waited for.
  struct Search {
    MissingCells& missing;
    std::vector<std::uint32_t>& way;  // to what is being traced
    bool any;                         // hit will do
    bool expands = false;             // the cells on the way that it follows
    bool is_exact = true;             // the cell there was known when it was noted, with its entry into its outline
  };
  Search* search = nullptr;
};

// One step of a search's way, while one lives; of other rays nothing.
class WayStep {
 public:
  WayStep(RayContext& context, std::size_t index) : search_(context.search) {
    if (search_) search_->way.push_back(std::uint32_t(index));
  }
  ~WayStep() {
    if (search_) search_->way.pop_back();
  }
  WayStep(const WayStep&) = delete;
  WayStep& operator=(const WayStep&) = delete;

 private:
  RayContext::Search* const search_;
};

class Instances;

// What rays of a stream can go through together. Immutable.
class Passage {
 public:
  virtual ~Passage() = default;
  // All of a leg but the ray.
  virtual StreamRay::Leg leg() const = 0;
  // What StreamRay is told of, for a ray in the frame of the passage: shortens it as Embree's callbacks do.
  virtual void met(std::uint32_t tree, const TreeHit& hit, RayContext& context, RTCRay& ray) const = 0;
  virtual void intersect_other(std::uint32_t other, RayContext& context, RTCRayHit& ray) const = 0;
  virtual void occlude_other(std::uint32_t other, RayContext& context, RTCRay& ray) const = 0;
  // If that is an instance, which; null: it is none.
  struct Placed {
    const Instances* all;
    std::uint32_t index;
  };
  virtual Placed placed(std::uint32_t other) const {
    (void)other;
    return {nullptr, 0};
  }
};

// Through one surface.
class SurfacePassage final : public Passage {
 public:
  // `key`: of its cell. The patch must outlive it.
  SurfacePassage(const SurfacePatch& patch, Key key) : patch_(patch), key_(key) {}
  StreamRay::Leg leg() const override;
  void met(std::uint32_t tree, const TreeHit& hit, RayContext& context, RTCRay& ray) const override;
  void intersect_other(std::uint32_t, RayContext&, RTCRayHit&) const override {}  // there are none
  void occlude_other(std::uint32_t, RayContext&, RTCRay&) const override {}

 private:
  const SurfacePatch& patch_;
  const Key key_;
};

class ModelRoot {
 public:
  virtual ~ModelRoot() = default;
  // Null: there is none at the moment, rays go through one by one.
  virtual const Passage* passage() const { return nullptr; }
  virtual void intersect(RayContext& context, RTCRayHit& ray) const = 0;
  virtual void occluded(RayContext& context, RTCRay& ray) const = 0;
  // Of a search: traces the cell at the end of a way that begins here. False if one on the way is not resident and may
  // not be expanded. No way leads into a root without cells.
  virtual bool follow(CellList::Way way, RayContext& context, RTCRayHit& ray) const {
    (void)way, (void)context, (void)ray;
    return true;
  }
  // Adds the roots of what is placed in its resident cells.
  virtual void add_placed(std::vector<const ModelRoot*>& roots) const { (void)roots; }
  // Between two passes, while nothing is traced: rays go through what is resident below faster from now on, which must
  // stay so until unbraid(). After the roots placed in it, as their boxes become closer by that. Returns the bytes it
  // costs.
  virtual std::size_t braid() const { return 0; }
  virtual void unbraid() const {}
  const Bounds3f& bounds() const { return bounds_; }
  // Within them, what it holds or may come to hold by all that is known of it now. While nothing is traced.
  virtual Bounds3f known_bounds() const { return bounds_; }
  virtual std::size_t bytes() const = 0;  // of the root alone, nothing expanded

 protected:
  explicit ModelRoot(const Bounds3f& bounds) : bounds_(bounds) {}

 private:
  Bounds3f bounds_;
};

// Traces a patch for a ray that may have a hit already; of two hits at one distance the smaller rank wins. Returns
// whether the patch holds the nearest hit now.
bool intersect_patch(const SurfacePatch& patch, Key key, RayContext& context, RTCRay& ray);
// The second half of it: what has been met up to ray.tfar.
bool take_hit(const SurfacePatch& patch, Key key, const TreeHit& hit, RayContext& context, RTCRay& ray);
// Of the nearest hit so far, while its patch is there.
HitRank rank_of_hit(const RayContext& context);
TreeRay tree_ray(const RTCRay& ray);
// As Embree's callbacks say that something is in the way: tfar becomes -infinity.
void occlude_with_patch(const SurfacePatch& patch, const RayContext& context, RTCRay& ray);

// A part as one of the individuals that it describes, seen from somewhere: what its cells are a pure function of.
struct RootSource {
  std::shared_ptr<const Part> part;
  std::shared_ptr<const Footprint> footprint;  // null: everything in full
  Key individual = 0;
  CacheEntry* parent = nullptr;  // the entry that owns the root, if one does
  Bounds3f bounds;
  Key moment = 0;  // of the shutter, by number, if the part is of one
};

// Cells behind a cache; what stands in them is placed by `roots`. All must outlive the root.
// `scratch`: for surfaces that are evicted; null: they are expanded again.
class Roots;
class ScratchFile;
std::unique_ptr<ModelRoot> make_lazy_root(RootSource source, Roots& roots, GeometryCache& cache,
                                          ExpansionCounts& counts, ScratchFile* scratch);
// What a ray holds at once at most: the bytes of a chain of cells from a root to a surface, through the largest child
// of each. Of the longest below the roots given. Expands such a chain for each part.
std::size_t largest_chain_bytes(const std::vector<const ModelRoot*>& roots);
// Expands every cell of the lazy roots among those given and of all that stands in them, on `threads` threads.
void expand_everything(std::vector<const ModelRoot*> roots, int threads);
// The whole final mesh as one patch.
std::unique_ptr<ModelRoot> make_flat_root(const RootSource& source, ExpansionCounts& counts,
                                          const UvReaders& uv_readers, int threads);

}  // namespace meristem
