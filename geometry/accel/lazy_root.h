// LazyRoot: a part as one individual, whose cells are expanded when rays meet them and live in a cache.
#pragma once

#include "geometry/accel/braided_cells.h"
#include "geometry/accel/cell_entry.h"
#include "geometry/accel/roots.h"

namespace meristem {

class LazyRoot final : public ModelRoot {
 public:
  LazyRoot(RootSource source, Roots& roots, GeometryCache& cache, ExpansionCounts& counts, ScratchFile* scratch);

  void intersect(RayContext& context, RTCRayHit& ray) const override;
  void occluded(RayContext& context, RTCRay& ray) const override;
  bool follow(CellList::Way way, RayContext& context, RTCRayHit& ray) const override;
  const Passage* passage() const override;
  void add_placed(std::vector<const ModelRoot*>& roots) const override;
  std::size_t braid() const override;
  void unbraid() const override { braided_.reset(), lone_.reset(); }
  Bounds3f known_bounds() const override;
  std::size_t bytes() const override { return sizeof(*this); }
  const Part* part() const { return source_.part.get(); }
  const Model& model() const { return *source_.part->model; }

  // Cells, expanded if they are not resident; nullptr: they failed.
  CellEntry* root(const RayUse& use = {}) const;
  CellEntry* child(CellEntry& parent, std::size_t index, const RayUse& use = {}) const;
  // nullptr: not resident.
  CellEntry* found(CacheSlot& slot) const { return static_cast<CellEntry*>(cache_.find(slot)); }

  // A child as a ray meets it. nullptr: there is nothing to trace; either it failed, or the ray expands nothing and has
  // noted it.
  CellEntry* entered_child(CellEntry& parent, std::size_t index, RayContext& context, const RTCRay& ray) const;
  // A cell that was noted before and is not resident. Whether it has been noted once more, or need not be.
  bool note_child_anew(CellEntry& parent, std::size_t index, float entry, const RTCRay& ray,
                       RayContext::Search& search) const;

 private:
  bool takes_braid(const RayContext& context) const { return braided_ && !context.search && !context.visits; }
  CellEntry* entered_root(RayContext& context, const RTCRay& ray) const;
  CellEntry* resident(CacheSlot& slot, RayContext& context) const;
  float root_entry(const RTCRay& ray) const { return earliest_entry(with_rounding_margin(bounds()), span_of(ray)); }

  // What stands on a ground must not depend on the view, so the ground is expanded in full.
  const Footprint* ground_footprint() const { return source_.part->placer ? nullptr : source_.footprint.get(); }
  // What tells its cells from those of other roots of the model.
  Key identity() const;
  Key child_name(const CellEntry& parent, std::size_t index) const;

  std::unique_ptr<CacheEntry> make_root_entry() const;
  template <class Cut>
  std::unique_ptr<CacheEntry> make_entry(const Cut& cut, int level, const Bounds3f& bounds, Key key) const;
  template <class Cut>
  std::unique_ptr<CacheEntry> make_ground_entry(const Cut& cut, int level, const Bounds3f& bounds, Key key) const;
  template <class Make>
  std::unique_ptr<CacheEntry> or_as_box(const Bounds3f& bounds, Key key, const Make& make) const;
  template <class Cut>
  ExpandedCell expanded(const Cut& cut, int level) const;
  void count(MadeCell cell, CacheEntry& entry) const;
  std::unique_ptr<CacheEntry> ground_entry(const std::shared_ptr<const ExpandedCell>& ground, const Bounds3f& bounds,
                                           Key key, int level) const;
  std::unique_ptr<CacheEntry> split_entry(std::shared_ptr<const InnerCell> inner, std::vector<Bounds3f> child_bounds,
                                          Key key, int level) const;
  std::unique_ptr<CacheEntry> entry_of(Expansion& expansion, const Bounds3f& bounds, Key key, int level) const;
  std::unique_ptr<CacheEntry> kept_surface(Key name, Key key) const;
  std::unique_ptr<CellEntry> surface_entry(std::unique_ptr<SurfacePatch> patch, Key key) const;
  std::unique_ptr<CacheEntry> make_child_entry(const CellEntry& parent, std::size_t index) const;
  std::unique_ptr<CacheEntry> make_group_entry(const CellEntry& parent, std::size_t group) const;
  Bounds3f furnished_bounds(const Bounds3f& ground) const;
  std::unique_ptr<CellEntry> furnished(const CellMesh& ground) const;
  std::unique_ptr<CellEntry> placed(const std::vector<Placement>& placements, std::uint32_t first = 0) const;
  void check_bounds(const Bounds3f& bounds, const Bounds3f& real) const;

  const RootSource source_;
  Roots& roots_;
  GeometryCache& cache_;
  ExpansionCounts& counts_;
  const std::shared_ptr<LeafStore> store_;  // null: none
  const Key name_;                          // of its root cell, for rays that wait
  const Key number_;                        // among those that know their cells
  mutable CacheSlot slot_;
  mutable std::optional<Bounds3f> known_bounds_;         // once it has been expanded; closer once braided
  mutable std::unique_ptr<const BraidedCells> braided_;  // null: rays go through the cells
  mutable std::optional<const SurfacePassage> lone_;     // its one cell, while others would be braided
};

}  // namespace meristem
