#include "geometry/accel/braided_cells.h"
#include "geometry/accel/instances.h"
#include "geometry/accel/leaf_store.h"
#include "geometry/accel/model_root.h"
#include "geometry/accel/proxy_scene.h"
#include "geometry/accel/roots.h"
#include "geometry/base/parallel.h"
#include "geometry/cells/level_of_detail.h"

#include <fmt/format.h>

#include <atomic>
#include <bit>
#include <cmath>
#include <functional>
#include <set>

namespace meristem {

namespace {

class LazyRoot;

// While one lives, its ray is in a cell.
class InUse {
 public:
  InUse(RayContext& context, CacheEntry& cell) : context_(context), used_{&cell, context.use.cells} {
    context.use.cells = &used_;
  }
  ~InUse() { context_.use.cells = used_.outer; }
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;

 private:
  RayContext& context_;
  const UsedEntry used_;
};

// What an entry costs by resident set: between arrays that come and go malloc leaves gaps that it cannot use.
std::size_t with_gaps(std::size_t bytes) { return bytes + bytes / 8; }

// A resident cell: a surface patch, child cells behind a scene of their bounds, or placed parts.
class CellEntry : public CacheEntry {
 public:
  CellEntry(std::unique_ptr<SurfacePatch> patch, Key key)
      : patch_(std::move(patch)), key_(key), real_bounds_(patch_->tessellation().bounds()) {
    bytes = with_gaps(patch_->bytes() + sizeof(*this));
    label.is_surface = true;
    label.tree_bytes = patch_->bytes() - patch_->tessellation().bytes();
  }
  CellEntry(const LazyRoot& root, std::unique_ptr<InnerCell> inner, std::shared_ptr<KnownChildren> known);
  CellEntry() = default;
  // What is placed may name the entry as its owner, so it comes in afterwards.
  void set_instances(std::unique_ptr<Instances> instances) {
    instances_ = std::move(instances);
    real_bounds_ = instances_->bounds();
    bytes = with_gaps(instances_->bytes() + sizeof(*this));
    label.tree_bytes = bytes;
  }

  void intersect(RayContext& context, RTCRayHit& ray) {
    const InUse in_use(context, *this);
    if (patch_) {
      if (intersect_patch(*patch_, key_, context, ray.ray)) context.use.nearest = this;
    } else if (proxies_) {
      proxies_->scene().intersect(context, ray);
    } else {
      instances_->intersect(context, ray);
    }
  }
  void occluded(RayContext& context, RTCRay& ray) {
    const InUse in_use(context, *this);
    if (patch_)
      occlude_with_patch(*patch_, context, ray);
    else if (proxies_)
      proxies_->scene().occluded(context, ray);
    else
      instances_->occluded(context, ray);
  }

  // Where the surface goes when it is evicted.
  void set_store(const std::shared_ptr<LeafStore>& store) { store_ = store; }
  void forgotten() override {
    if (store_) store_->keep(name, *patch_, label);
  }

  // As ModelRoot::follow(): the way goes on with one of the children or instances, or ends here.
  bool follow(CellList::Way way, RayContext& context, RTCRayHit& ray);

  const LazyRoot& root() const { return *root_; }
  const SurfacePatch* patch() const { return patch_.get(); }
  const InnerCell* inner() const { return inner_.get(); }
  const Instances* instances() const { return instances_.get(); }
  CacheSlot& slot(std::size_t child) { return slots_[child]; }
  ProxyScene& proxies() { return *proxies_; }
  // Of a surface or of placed parts: their own. Of child cells: the union of their bounds before expansion.
  const Bounds3f& real_bounds() const { return real_bounds_; }
  // Small boxes that hold all of it; none if they would not be few.
  std::vector<Bounds3f> boxes() const;

 private:
  std::unique_ptr<SurfacePatch> patch_;
  Key key_ = 0;
  Bounds3f real_bounds_;
  const LazyRoot* root_ = nullptr;
  std::unique_ptr<InnerCell> inner_;
  std::unique_ptr<CacheSlot[]> slots_;
  std::unique_ptr<ProxyScene> proxies_;
  std::unique_ptr<Instances> instances_;
  std::shared_ptr<LeafStore> store_;  // of its root, which it may outlive; only of a surface
};

RaySpan span_of(const RTCRay& ray) {
  return {{ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}, ray.tnear, ray.tfar};
}

// The box of a cell that could not be expanded, as a surface.
Tessellation box_of(const Bounds3f& b, Key key) {
  Tessellation t;
  for (int i = 0; i < 8; ++i) {
    t.positions.push_back(
        {i & 1 ? b.upper.x : b.lower.x, i & 2 ? b.upper.y : b.lower.y, i & 4 ? b.upper.z : b.lower.z});
    t.attributes.push_back({PackedNormal::pack(t.positions.back() - b.center()), {}});
  }
  t.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  t.triangle_sources.assign(t.triangles.size(), {0, 0});
  t.leaves = {{}};
  t.origins = {FaceOrigin{.key = key}};
  return t;
}

class LazyRoot final : public ModelRoot {
 public:
  LazyRoot(RootSource source, Roots& roots, GeometryCache& cache, ExpansionCounts& counts, ScratchFile* scratch)
      : ModelRoot(source.bounds),
        source_(std::move(source)),
        roots_(roots),
        cache_(cache),
        counts_(counts),
        store_(scratch ? std::make_shared<LeafStore>(*scratch) : nullptr),
        reach_(source_.part->placer ? source_.part->placer->reach() : Bounds3f{}),
        name_(hash_keys(identity(), std::bit_cast<std::uintptr_t>(source_.part.get()))),
        number_(roots.known().new_root()) {}

  void intersect(RayContext& context, RTCRayHit& ray) const override {
    if (takes_braid(context))
      braided_->intersect(context, ray);
    else if (CellEntry* cell = entered_root(context, ray.ray))
      cell->intersect(context, ray);
  }
  void occluded(RayContext& context, RTCRay& ray) const override {
    if (takes_braid(context))
      braided_->occluded(context, ray);
    else if (CellEntry* cell = entered_root(context, ray))
      cell->occluded(context, ray);
  }
  bool follow(CellList::Way way, RayContext& context, RTCRayHit& ray) const override {
    ++context.acquired;
    CellEntry* cell = context.search->expands ? root(context.use) : found(slot_);
    if (cell) return cell->follow(way, context, ray);
    if (slot_.state() == CacheSlot::State::Failed) return true;
    return way.empty() && note_anew(slot_.was_expanded(), name_, root_entry(ray.ray), ray.ray, *context.search);
  }
  std::size_t braid(std::vector<const ModelRoot*>& below) const override;
  void unbraid() const override { braided_.reset(); }
  std::size_t bytes() const override { return sizeof(*this); }
  const Part* part() const { return source_.part.get(); }
  const Model& model() const { return *source_.part->model; }

  CellEntry* root(const RayUse& use = {}) const {
    return static_cast<CellEntry*>(cache_.acquire(slot_, source_.parent, use, [this] {
      std::unique_ptr<CacheEntry> entry = make_root_entry();
      entry->name = name_;
      return entry;
    }));
  }
  CellEntry* child(CellEntry& parent, std::size_t index, const RayUse& use = {}) const {
    return static_cast<CellEntry*>(cache_.acquire(parent.slot(index), &parent, use, [this, &parent, index] {
      const InnerCell& inner = *parent.inner();
      std::unique_ptr<CacheEntry> entry = kept_surface(child_name(inner, index), inner.child_keys[index]);
      if (!entry)
        entry = make_entry([&] { return child_cell(model(), inner, index); }, inner.level, inner.child_bounds[index],
                           inner.child_keys[index]);
      entry->name = child_name(inner, index);
      if (!parent.proxies().knows(index)) {  // for good, whatever becomes of the child
        const auto& cell = static_cast<const CellEntry&>(*entry);
        parent.proxies().tighten(index, cell.real_bounds(), cell.boxes());
      }
      return entry;
    }));
  }

  // A child as a ray meets it. nullptr: there is nothing to trace; either it failed, or the ray expands nothing and has
  // noted it.
  CellEntry* entered_child(CellEntry& parent, std::size_t index, RayContext& context, const RTCRay& ray) const {
    ++context.acquired;
    if (context.only_resident) return resident(parent.slot(index), context);
    if (!context.search) return child(parent, index, context.use);
    CacheSlot& slot = parent.slot(index);
    if (CellEntry* cell = found(slot)) return cell;
    const WayStep step(context, index);
    const InnerCell& inner = *parent.inner();
    note(slot, parent.proxies().knows(index), child_name(inner, index), parent.proxies().entry(index, span_of(ray)),
         ray, *context.search);
    return nullptr;
  }
  // A cell that was noted before and is not resident. Whether it has been noted once more, or need not be.
  bool note_child_anew(CellEntry& parent, std::size_t index, float entry, const RTCRay& ray,
                       RayContext::Search& search) const {
    return note_anew(parent.proxies().knows(index), child_name(*parent.inner(), index), entry, ray, search);
  }
  CellEntry* found(CacheSlot& slot) const { return static_cast<CellEntry*>(cache_.find(slot)); }

 private:
  bool takes_braid(const RayContext& context) const { return braided_ && !context.search && !context.visits; }
  CellEntry* entered_root(RayContext& context, const RTCRay& ray) const {
    ++context.acquired;
    if (context.only_resident) return resident(slot_, context);
    if (!context.search) return root(context.use);
    if (CellEntry* cell = found(slot_)) return cell;
    note(slot_, slot_.was_expanded(), name_, root_entry(ray), ray, *context.search);
    return nullptr;
  }
  CellEntry* resident(CacheSlot& slot, RayContext& context) const {
    CellEntry* const cell = found(slot);
    if (!cell && slot.state() != CacheSlot::State::Failed) context.has_passed_by = true;
    return cell;
  }
  float root_entry(const RTCRay& ray) const { return earliest_entry(with_rounding_margin(bounds()), span_of(ray)); }

  static void note(const CacheSlot& slot, bool is_known, Key name, float entry, const RTCRay& ray,
                   RayContext::Search& search) {
    if (entry <= ray.tfar && slot.state() != CacheSlot::State::Failed)
      search.missing.note(name, entry, is_known, search.way);
  }
  static bool note_anew(bool is_known, Key name, float entry, const RTCRay& ray, RayContext::Search& search) {
    if (search.knows || !is_known) return false;
    if (entry <= ray.tfar) search.missing.note(name, entry, true, search.way);
    return true;
  }

  // What stands on a ground must not depend on the view, so the ground is expanded in full.
  const Footprint* ground_footprint() const { return source_.part->placer ? nullptr : source_.footprint.get(); }

  // What tells its cells from those of other roots of the model.
  Key identity() const {
    const double footprint = source_.footprint ? source_.footprint->at({}) : 0;
    const Key of_first = hash_keys(source_.individual, std::bit_cast<Key>(footprint));
    return source_.moment == 0 ? of_first : hash_keys(of_first, source_.moment);
  }

  Key child_name(const InnerCell& inner, std::size_t index) const {
    return hash_keys(name_, inner.child_keys[index], Key(inner.level));
  }

  // A cell that was a surface when it was evicted; nullptr if it has to be expanded.
  std::unique_ptr<CacheEntry> kept_surface(Key name, Key key) const {
    if (!store_) return nullptr;
    try {
      std::optional<LeafStore::Leaf> leaf = store_->find(name);
      if (!leaf) return nullptr;
      auto entry = surface_entry(std::move(leaf->patch), key);
      entry->label.cell = leaf->label.cell;
      entry->label.cell_class = leaf->label.cell_class;
      return entry;
    } catch (const std::exception&) {
      return nullptr;
    }
  }

  std::unique_ptr<CellEntry> surface_entry(std::unique_ptr<SurfacePatch> patch, Key key) const {
    auto entry = std::make_unique<CellEntry>(std::move(patch), key);
    entry->set_store(store_);
    return entry;
  }

  std::unique_ptr<CacheEntry> make_root_entry() const {
    if (!source_.part->model) return placed(source_.part->members);
    const Key key = hash_keys(hash_text(model().name()), source_.individual);
    if (auto entry = kept_surface(name_, key)) return entry;
    return make_entry([this] { return root_cell(model(), ground_footprint(), source_.individual); }, 0, bounds(), key);
  }

  // Never throws: a cell that cannot be expanded becomes its box, once, counted and reported.
  template <class Cut>
  std::unique_ptr<CacheEntry> make_entry(const Cut& cut, int level, const Bounds3f& bounds, Key key) const {
    try {
      const double start_s = counts_.now_s();
      CellMesh mesh = cut();
      const std::int32_t symbol = mesh.mesh.origins[mesh.mesh.face_origins[0]].symbol;
      Expansion expansion = expand(model(), std::move(mesh), level);
      const double built_from_s = counts_.now_s();
      auto entry = entry_of(expansion, bounds, key, level);
      const Bounds3f& real_bounds = static_cast<const CellEntry&>(*entry).real_bounds();
      counts_.add(
          {model(), level, hash_keys(key, identity()), symbol, expansion, start_s, built_from_s, bounds, real_bounds},
          *entry);
      return entry;
    } catch (const std::exception& error) {
      counts_.add_defect(fmt::format("a cell of model \"{}\" could not be expanded: {}", model().name(), error.what()));
      return std::make_unique<CellEntry>(std::make_unique<SurfacePatch>(box_of(bounds, key)), key);
    }
  }

  std::unique_ptr<CacheEntry> entry_of(Expansion& expansion, const Bounds3f& bounds, Key key, int level) const {
    if (expansion.inner) {
      for (Bounds3f& b : expansion.inner->child_bounds) b = bounds_with_reach(b, reach_);
      auto known = roots_.known().of(hash_keys(number_, key, Key(level)), expansion.inner->child_count());
      std::unique_ptr<CacheEntry> entry;
      run_isolated([&] { entry = std::make_unique<CellEntry>(*this, std::move(expansion.inner), std::move(known)); });
      return entry;
    }
    if (source_.part->placer) {
      std::vector<Placement> placements;
      source_.part->placer->place(expansion.mesh, source_.individual, placements);
      auto entry = placed(placements);
      check_bounds(bounds, entry->real_bounds());
      return entry;
    }
    auto entry = surface_entry(std::make_unique<SurfacePatch>(std::move(*expansion.leaf)), key);
    check_bounds(bounds, entry->real_bounds());
    return entry;
  }

  std::unique_ptr<CellEntry> placed(const std::vector<Placement>& placements) const {
    auto entry = std::make_unique<CellEntry>();
    run_isolated([&] {
      entry->set_instances(roots_.place(placements, source_.footprint, entry.get(), source_.individual, false));
    });
    return entry;
  }

  void check_bounds(const Bounds3f& bounds, const Bounds3f& real) const {
    if (!real.empty() && !bounds.contains(real))
      counts_.add_defect(fmt::format("a cell of model \"{}\" left its bounds", model().name()));
  }

  const RootSource source_;
  Roots& roots_;
  GeometryCache& cache_;
  ExpansionCounts& counts_;
  const std::shared_ptr<LeafStore> store_;  // null: none
  const Bounds3f reach_;                    // of what stands on it; empty: it is shown itself
  const Key name_;                          // of its root cell, for rays that wait
  const Key number_;                        // among those that know their cells
  mutable CacheSlot slot_;
  mutable std::unique_ptr<const BraidedCells> braided_;  // null: rays go through the cells
};

std::vector<Bounds3f> CellEntry::boxes() const {
  std::vector<Bounds3f> boxes;
  if (patch_)
    for (const SurfaceTree::Part& p : patch_->tree().parts(Outline::most_boxes)) boxes.push_back(p.box);
  else if (inner_)
    boxes = inner_->child_bounds;
  else
    boxes = instances_->few_boxes();
  if (boxes.size() > Outline::most_boxes) boxes.clear();
  return boxes;
}

bool CellEntry::follow(CellList::Way way, RayContext& context, RTCRayHit& ray) {
  if (way.empty()) {
    if (context.visits) ++context.visits[label.cell_class];
    if (context.search->any)
      occluded(context, ray.ray);
    else
      intersect(context, ray);
    return true;
  }
  const InUse in_use(context, *this);
  if (instances_) return instances_->follow(way, context, ray);
  const WayStep step(context, way[0]);
  ++context.acquired;
  CacheSlot& slot = slots_[way[0]];
  CellEntry* cell = root_->found(slot);
  if (!cell) {
    // It may be better known since it was noted, and the ray shorter
    const float entry = proxies_->entry(way[0], span_of(ray.ray));
    if (!(entry <= ray.ray.tfar)) return true;
    if (context.search->expands) cell = root_->child(*this, way[0], context.use);
    if (!cell) {
      if (slot.state() == CacheSlot::State::Failed) return true;
      return way.size() == 1 && root_->note_child_anew(*this, way[0], entry, ray.ray, *context.search);
    }
  }
  return cell->follow(way.subspan(1), context, ray);
}

// What stands in the boxes of child cells; `parent` is their CellEntry.
void intersect_child(void* parent, std::uint32_t index, RayContext& context, RTCRayHit& ray) {
  auto& entry = *static_cast<CellEntry*>(parent);
  if (CellEntry* cell = entry.root().entered_child(entry, index, context, ray.ray)) {
    const WayStep step(context, index);
    if (context.visits) ++context.visits[cell->label.cell_class];
    cell->intersect(context, ray);
  }
}

void occluded_child(void* parent, std::uint32_t index, RayContext& context, RTCRay& ray) {
  auto& entry = *static_cast<CellEntry*>(parent);
  if (CellEntry* cell = entry.root().entered_child(entry, index, context, ray)) {
    const WayStep step(context, index);
    if (context.visits) ++context.visits[cell->label.cell_class];
    cell->occluded(context, ray);
  }
}

// What a braid is made of: the surfaces below a cell that is split, and what else stands in its children.
struct Strands {
  std::vector<BraidedCells::Surface> surfaces;
  std::vector<BraidedCells::Other> others;
  std::vector<const ModelRoot*>& roots;  // that stand in instances

  void add(CellEntry& cell) {
    for (std::uint32_t i = 0; i < cell.inner()->child_count(); ++i) {
      CellEntry* const child = cell.root().found(cell.slot(i));
      if (child && child->patch()) {
        surfaces.push_back({child->patch(), cell.inner()->child_keys[i]});
      } else if (child && child->inner()) {
        add(*child);
      } else {
        others.push_back({cell.proxies().bounds(i), {&cell, intersect_child, occluded_child}, i});
        if (child) add_roots(*child);
      }
    }
  }
  void add_roots(const CellEntry& cell) {
    const std::vector<const ModelRoot*> placed = cell.instances()->roots();
    roots.insert(roots.end(), placed.begin(), placed.end());
  }
};

std::size_t LazyRoot::braid(std::vector<const ModelRoot*>& below) const {
  CellEntry* const cell = found(slot_);
  if (!cell || cell->patch()) return 0;
  Strands strands{{}, {}, below};
  if (!cell->inner()) {
    strands.add_roots(*cell);
    return 0;
  }
  strands.add(*cell);
  braided_ = std::make_unique<const BraidedCells>(std::move(strands.surfaces), std::move(strands.others));
  return braided_->bytes();
}

CellEntry::CellEntry(const LazyRoot& root, std::unique_ptr<InnerCell> inner, std::shared_ptr<KnownChildren> known)
    : root_(&root), inner_(std::move(inner)), slots_(std::make_unique<CacheSlot[]>(inner_->child_count())) {
  for (const Bounds3f& b : inner_->child_bounds) real_bounds_.extend(b);
  proxies_ = std::make_unique<ProxyScene>(inner_->child_bounds, BoxContents{this, intersect_child, occluded_child},
                                          std::move(known));
  bytes = with_gaps(proxies_->bytes() + inner_->bytes() + inner_->child_count() * sizeof(CacheSlot) + sizeof(*this));
  label.tree_bytes = proxies_->bytes();
}

}  // namespace

std::unique_ptr<ModelRoot> make_lazy_root(RootSource source, Roots& roots, GeometryCache& cache,
                                          ExpansionCounts& counts, ScratchFile* scratch) {
  return std::make_unique<LazyRoot>(std::move(source), roots, cache, counts, scratch);
}

namespace {

class ChainMeasure {
 public:
  std::size_t largest_below(const ModelRoot& root) {
    const auto* lazy = dynamic_cast<const LazyRoot*>(&root);
    if (!lazy || !seen_.insert(lazy->part()).second) return 0;
    CellEntry* cell = lazy->root();
    return cell ? below(*cell) : 0;
  }

 private:
  std::size_t below(CellEntry& cell) {
    std::size_t most = 0;
    if (cell.instances())
      for (const ModelRoot* root : cell.instances()->roots()) most = std::max(most, largest_below(*root));
    if (cell.inner())
      if (CellEntry* child = cell.root().child(cell, largest_child(cell))) most = below(*child);
    return cell.bytes + most;
  }
  static std::size_t largest_child(const CellEntry& cell) {
    const InnerCell& inner = *cell.inner();
    std::size_t largest = 0;
    double most = -1;
    for (std::size_t i = 0; i < inner.child_count(); ++i) {
      double faces = 0;
      for (std::uint32_t f : inner.faces_of_child(i))
        faces += wanted_faces(cell.root().model(), inner.cell, f, inner.level);
      if (faces > most) most = faces, largest = i;
    }
    return largest;
  }

  std::set<const Part*> seen_;
};

}  // namespace

std::size_t largest_chain_bytes(const std::vector<const ModelRoot*>& roots) {
  std::size_t most = 0;
  ChainMeasure measure;
  for (const ModelRoot* root : roots) most = std::max(most, measure.largest_below(*root));
  return most;
}

void expand_everything(std::vector<const ModelRoot*> roots, int threads) {
  std::set<const ModelRoot*> seen;
  std::vector<std::function<CellEntry*()>> generation;
  const auto add_root = [&](const ModelRoot* root) {
    const auto* lazy = dynamic_cast<const LazyRoot*>(root);
    if (lazy && seen.insert(lazy).second) generation.push_back([lazy] { return lazy->root(); });
  };
  for (const ModelRoot* root : roots) add_root(root);
  while (!generation.empty()) {
    std::vector<CellEntry*> cells(generation.size());
    std::atomic<std::size_t> counter{0};
    run_threads(threads, [&](int) {
      for (std::size_t i; (i = counter.fetch_add(1)) < generation.size();) cells[i] = generation[i]();
    });
    generation.clear();
    for (CellEntry* cell : cells) {
      if (!cell) continue;
      for (std::size_t i = 0; cell->inner() && i < cell->inner()->child_count(); ++i)
        generation.push_back([cell, i] { return cell->root().child(*cell, i); });
      if (cell->instances())
        for (const ModelRoot* root : cell->instances()->roots()) add_root(root);
    }
  }
}

}  // namespace meristem
