#include "geometry/accel/lazy_root.h"

#include "geometry/base/parallel.h"

#include <fmt/format.h>

#include <bit>

namespace meristem {

namespace {

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
  t.has_uv = false;
  t.origins.add({.key = key});
  return t;
}

void note(const CacheSlot& slot, const CellList::Cell& cell, const RTCRay& ray, RayContext::Search& search) {
  if (enters(cell.entry, ray.tfar) && slot.state() != CacheSlot::State::Failed) search.missing.note(cell, search.way);
}
bool note_anew(bool is_known, Key name, float entry, const RTCRay& ray, RayContext::Search& search) {
  if (search.is_exact || !is_known) return false;
  if (enters(entry, ray.tfar)) search.missing.note({name, entry, true, true}, search.way);
  return true;
}

}  // namespace

LazyRoot::LazyRoot(RootSource source, Roots& roots, GeometryCache& cache, ExpansionCounts& counts, ScratchFile* scratch)
    : ModelRoot(source.bounds),
      source_(std::move(source)),
      roots_(roots),
      cache_(cache),
      counts_(counts),
      store_(scratch ? std::make_shared<LeafStore>(*scratch) : nullptr),
      name_(hash_keys(identity(), std::bit_cast<std::uintptr_t>(source_.part.get()))),
      number_(roots.known().new_root()) {}

void LazyRoot::intersect(RayContext& context, RTCRayHit& ray) const {
  if (takes_braid(context))
    braided_->intersect(context, ray);
  else if (CellEntry* cell = entered_root(context, ray.ray))
    cell->intersect(context, ray);
}

void LazyRoot::occluded(RayContext& context, RTCRay& ray) const {
  if (takes_braid(context))
    braided_->occluded(context, ray);
  else if (CellEntry* cell = entered_root(context, ray))
    cell->occluded(context, ray);
}

bool LazyRoot::follow(CellList::Way way, RayContext& context, RTCRayHit& ray) const {
  ++context.acquired;
  CellEntry* cell = context.search->expands ? root(context.use) : found(slot_);
  if (cell) return cell->follow(way, context, ray);
  if (slot_.state() == CacheSlot::State::Failed) return true;
  return way.empty() && note_anew(slot_.was_expanded(), name_, root_entry(ray.ray), ray.ray, *context.search);
}

CellEntry* LazyRoot::entered_root(RayContext& context, const RTCRay& ray) const {
  ++context.acquired;
  if (context.only_resident) return resident(slot_, context);
  if (!context.search) return root(context.use);
  if (CellEntry* cell = found(slot_)) return cell;
  note(slot_, {name_, root_entry(ray), slot_.was_expanded(), true}, ray, *context.search);
  return nullptr;
}

CellEntry* LazyRoot::entered_child(CellEntry& parent, std::size_t index, RayContext& context, const RTCRay& ray) const {
  ++context.acquired;
  if (context.only_resident) return resident(parent.slot(index), context);
  if (!context.search) return child(parent, index, context.use);
  CacheSlot& slot = parent.slot(index);
  if (CellEntry* cell = found(slot)) return cell;
  const WayStep step(context, index);
  // Outlines take time, and only of the cell that comes first it matters whether and where the ray enters it
  const ProxyScene& proxies = parent.proxies();
  const RaySpan span = span_of(ray);
  CellList::Cell cell{0, proxies.box_entry(index, span), proxies.knows(index), false};
  if (!enters(cell.entry, ray.tfar)) return nullptr;
  if (!context.search->any && context.search->missing.may_be_nearest(cell.entry)) {
    cell.entry = proxies.entry(index, span);
    cell.is_exact = true;
    if (!enters(cell.entry, ray.tfar)) return nullptr;
  }
  cell.name = child_name(parent, index);
  note(slot, cell, ray, *context.search);
  return nullptr;
}

CellEntry* LazyRoot::resident(CacheSlot& slot, RayContext& context) const {
  CellEntry* const cell = found(slot);
  if (!cell && slot.state() != CacheSlot::State::Failed) context.has_passed_by = true;
  return cell;
}

bool LazyRoot::note_child_anew(CellEntry& parent, std::size_t index, float entry, const RTCRay& ray,
                               RayContext::Search& search) const {
  return note_anew(parent.proxies().knows(index), child_name(parent, index), entry, ray, search);
}

// What `make` makes. Never throws: a cell that cannot be expanded becomes its box, once, counted and reported.
template <class Make>
std::unique_ptr<CacheEntry> LazyRoot::or_as_box(const Bounds3f& bounds, Key key, const Make& make) const {
  try {
    return make();
  } catch (const std::exception& error) {
    counts_.add_defect(fmt::format("a cell of model \"{}\" could not be expanded: {}", model().name(), error.what()));
    return std::make_unique<CellEntry>(std::make_unique<SurfacePatch>(box_of(bounds, key)), key);
  }
}

template <class Cut>
std::unique_ptr<CacheEntry> LazyRoot::make_entry(const Cut& cut, int level, const Bounds3f& bounds, Key key) const {
  return or_as_box(bounds, key, [&]() -> std::unique_ptr<CacheEntry> {
    if (source_.part->placer) return make_ground_entry(cut, level, bounds, key);
    const double start_s = counts_.now_s();
    ExpandedCell cell = expanded(cut, level);
    const double built_from_s = counts_.now_s();
    auto entry = entry_of(cell.expansion, bounds, key, level);
    count({model(), level, hash_keys(key, identity()), cell.symbol, cell.expansion, start_s, built_from_s, bounds},
          *entry);
    return entry;
  });
}

void LazyRoot::count(MadeCell cell, CacheEntry& entry) const {
  cell.real_bounds = static_cast<const CellEntry&>(entry).real_bounds();
  counts_.add(cell, entry);
}

template <class Cut>
ExpandedCell LazyRoot::expanded(const Cut& cut, int level) const {
  CellMesh mesh = cut();
  const std::int32_t symbol = mesh.mesh.origins[mesh.mesh.face_origins[0]].symbol;
  return {expand(model(), std::move(mesh), level, roots_.uv_readers()), symbol};
}

std::unique_ptr<CacheEntry> LazyRoot::make_root_entry() const {
  if (!source_.part->model) return placed(source_.part->members);
  const Key key = hash_keys(hash_text(model().name()), source_.individual);
  if (auto entry = kept_surface(name_, key)) return entry;
  return make_entry([this] { return root_cell(model(), ground_footprint(), source_.individual); }, 0, bounds(), key);
}

CellEntry* LazyRoot::root(const RayUse& use) const {
  return static_cast<CellEntry*>(cache_.acquire(slot_, source_.parent, use, [this] {
    std::unique_ptr<CacheEntry> entry = make_root_entry();
    entry->name = name_;
    if (!known_bounds_) known_bounds_ = static_cast<const CellEntry&>(*entry).real_bounds();
    return entry;
  }));
}

// With a margin, as those of cells: hits may lie a little beyond. What was known once holds for good.
Bounds3f LazyRoot::known_bounds() const { return known_bounds_ ? with_rounding_margin(*known_bounds_) : bounds(); }

CellEntry* LazyRoot::child(CellEntry& parent, std::size_t index, const RayUse& use) const {
  return static_cast<CellEntry*>(cache_.acquire(parent.slot(index), &parent, use, [this, &parent, index] {
    std::unique_ptr<CacheEntry> entry = make_child_entry(parent, index);
    entry->name = child_name(parent, index);
    if (!parent.proxies().knows(index)) {  // for good, whatever becomes of the child
      const auto& cell = static_cast<const CellEntry&>(*entry);
      parent.proxies().tighten(index, cell.real_bounds(), cell.boxes());
    }
    return entry;
  }));
}

Key LazyRoot::child_name(const CellEntry& parent, std::size_t index) const {
  const InnerCell* inner = parent.inner();
  return inner ? hash_keys(name_, inner->child_keys[index], Key(inner->level)) : hash_keys(parent.name, Key(index));
}

std::unique_ptr<CacheEntry> LazyRoot::make_child_entry(const CellEntry& parent, std::size_t index) const {
  if (parent.grove()) return make_group_entry(parent, index);
  const InnerCell& inner = *parent.inner();
  if (auto entry = kept_surface(child_name(parent, index), inner.child_keys[index])) return entry;
  return make_entry([&] { return child_cell(model(), inner, index); }, inner.level, parent.child_bounds()[index],
                    inner.child_keys[index]);
}

std::unique_ptr<CacheEntry> LazyRoot::make_group_entry(const CellEntry& parent, std::size_t group) const {
  const Grove& grove = *parent.grove();
  const Bounds3f& bounds = grove.bounds()[group];
  const Key key = child_name(parent, group);
  return or_as_box(bounds, key, [&]() -> std::unique_ptr<CacheEntry> {
    constexpr std::int32_t no_symbol = -1;
    const double start_s = counts_.now_s();
    auto entry = placed(grove.placements(group), grove.first_number(group));
    check_bounds(bounds, entry->real_bounds());
    count({model(), model().levels(), key, no_symbol, {}, start_s, start_s, bounds}, *entry);
    return entry;
  });
}

// A cell that was a surface when it was evicted; nullptr if it has to be expanded.
std::unique_ptr<CacheEntry> LazyRoot::kept_surface(Key name, Key key) const {
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

std::unique_ptr<CellEntry> LazyRoot::surface_entry(std::unique_ptr<SurfacePatch> patch, Key key) const {
  auto entry = std::make_unique<CellEntry>(std::move(patch), key);
  entry->set_store(store_);
  return entry;
}

std::unique_ptr<CacheEntry> LazyRoot::entry_of(Expansion& expansion, const Bounds3f& bounds, Key key, int level) const {
  if (expansion.inner) return split_entry(std::move(expansion.inner), {}, key, level);
  auto entry = surface_entry(std::make_unique<SurfacePatch>(std::move(*expansion.leaf)), key);
  check_bounds(bounds, entry->real_bounds());
  return entry;
}

std::unique_ptr<CacheEntry> LazyRoot::split_entry(std::shared_ptr<const InnerCell> inner,
                                                  std::vector<Bounds3f> child_bounds, Key key, int level) const {
  auto known = roots_.known().of(hash_keys(number_, key, Key(level)), inner->child_count());
  std::unique_ptr<CacheEntry> entry;
  run_isolated(
      [&] { entry = std::make_unique<CellEntry>(*this, std::move(inner), std::move(child_bounds), std::move(known)); });
  return entry;
}

// What a cell of ground expands to is the same for any root that has this model for its ground: it is expanded once for
// those that come to it soon after each other.
template <class Cut>
std::unique_ptr<CacheEntry> LazyRoot::make_ground_entry(const Cut& cut, int level, const Bounds3f& bounds,
                                                        Key key) const {
  const double start_s = counts_.now_s();
  const ShapeName name{hash_keys(key, Key(level), source_.individual), std::bit_cast<std::uintptr_t>(&model())};
  bool is_new = false;
  const auto ground = roots_.grounds().get(name, [&] {
    is_new = true;
    return std::make_shared<const ExpandedCell>(expanded(cut, level));
  });
  const double built_from_s = counts_.now_s();
  auto entry = ground_entry(ground, bounds, key, level);
  const Expansion nothing;
  count({model(), level, hash_keys(key, identity()), ground->symbol, is_new ? ground->expansion : nothing, start_s,
         built_from_s, bounds},
        *entry);
  return entry;
}

std::unique_ptr<CacheEntry> LazyRoot::ground_entry(const std::shared_ptr<const ExpandedCell>& ground,
                                                   const Bounds3f& bounds, Key key, int level) const {
  if (const InnerCell* inner = ground->expansion.inner.get()) {
    std::vector<Bounds3f> child_bounds;
    child_bounds.reserve(inner->child_count());
    for (const Bounds3f& b : inner->child_bounds) child_bounds.push_back(furnished_bounds(b));
    return split_entry({ground, inner}, std::move(child_bounds), key, level);
  }
  auto entry = furnished(ground->expansion.mesh);
  check_bounds(bounds, entry->real_bounds());
  return entry;
}

// Of what stands on ground in that box; empty: nothing does.
Bounds3f LazyRoot::furnished_bounds(const Bounds3f& ground) const {
  const Placer& placer = *source_.part->placer;
  if (placer.leaves_bare(ground)) return {};
  return bounds_with_reach(ground, placer.reach_on(ground, source_.footprint.get(), source_.individual)->all);
}

std::unique_ptr<CellEntry> LazyRoot::furnished(const CellMesh& ground) const {
  const Placer& placer = *source_.part->placer;
  auto furnishing = placer.furnish(ground, source_.individual);
  if (!Grove::is_worthwhile(*furnishing)) {
    std::vector<Placement> placements;
    furnishing->place(0, furnishing->face_count(), placements);
    return placed(placements);
  }
  const auto reach = placer.reach_on(furnishing->ground_bounds(), source_.footprint.get(), source_.individual);
  std::unique_ptr<CellEntry> entry;
  run_isolated([&] { entry = std::make_unique<CellEntry>(*this, Grove(std::move(furnishing), *reach)); });
  return entry;
}

std::unique_ptr<CellEntry> LazyRoot::placed(const std::vector<Placement>& placements, std::uint32_t first) const {
  auto entry = std::make_unique<CellEntry>();
  run_isolated([&] {
    entry->set_instances(roots_.place(placements, source_.footprint, entry.get(), source_.individual, false, first));
  });
  return entry;
}

void LazyRoot::check_bounds(const Bounds3f& bounds, const Bounds3f& real) const {
  if (!real.empty() && !bounds.contains(real))
    counts_.add_defect(fmt::format("a cell of model \"{}\" left its bounds", model().name()));
}

Key LazyRoot::identity() const {
  const double footprint = source_.footprint ? source_.footprint->at({}) : 0;
  const Key of_first = hash_keys(source_.individual, std::bit_cast<Key>(footprint));
  return source_.moment == 0 ? of_first : hash_keys(of_first, source_.moment);
}

std::unique_ptr<ModelRoot> make_lazy_root(RootSource source, Roots& roots, GeometryCache& cache,
                                          ExpansionCounts& counts, ScratchFile* scratch) {
  return std::make_unique<LazyRoot>(std::move(source), roots, cache, counts, scratch);
}

}  // namespace meristem
