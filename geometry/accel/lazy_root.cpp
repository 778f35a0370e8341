#include "geometry/accel/model_root.h"
#include "geometry/accel/proxy_scene.h"
#include "geometry/base/parallel.h"

#include <fmt/format.h>

#include <atomic>

namespace meristem {

namespace {

class LazyRoot;

// A resident cell: a surface patch, or child cells behind a scene of their bounds.
class CellEntry : public CacheEntry {
 public:
  CellEntry(std::unique_ptr<SurfacePatch> patch, Key key)
      : patch_(std::move(patch)), key_(key), real_bounds_(patch_->tessellation().bounds()) {
    bytes = patch_->bytes() + sizeof(*this);
    label.is_surface = true;
    label.tree_bytes = patch_->bytes() - patch_->tessellation().bytes();
  }
  CellEntry(const LazyRoot& root, std::unique_ptr<InnerCell> inner);

  bool is_leaf() const { return patch_ != nullptr; }
  const SurfacePatch& patch() const { return *patch_; }
  Key key() const { return key_; }
  const InnerCell& inner() const { return *inner_; }
  CacheSlot& slot(std::size_t child) { return slots_[child]; }
  ProxyScene& proxies() { return *proxies_; }
  // Of a surface: its own. Of child cells: the union of their bounds before expansion.
  const Bounds3f& real_bounds() const { return real_bounds_; }
  const LazyRoot& root() const { return *root_; }

 private:
  std::unique_ptr<SurfacePatch> patch_;
  Key key_ = 0;
  Bounds3f real_bounds_;
  const LazyRoot* root_ = nullptr;
  std::unique_ptr<InnerCell> inner_;
  std::unique_ptr<CacheSlot[]> slots_;
  std::unique_ptr<ProxyScene> proxies_;
};

// The box of a cell that could not be expanded, as a surface.
Tessellation box_of(const Bounds3f& b, Key key) {
  Tessellation t;
  for (int i = 0; i < 8; ++i) {
    t.positions.push_back(
        {i & 1 ? b.upper.x : b.lower.x, i & 2 ? b.upper.y : b.lower.y, i & 4 ? b.upper.z : b.lower.z});
    t.normals.push_back(normalize(t.positions.back() - b.center()));
    t.uv.push_back({});
  }
  t.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  t.triangle_origins.assign(t.triangles.size(), 0);
  t.origins = {FaceOrigin{.key = key}};
  return t;
}

class LazyRoot final : public ModelRoot {
 public:
  LazyRoot(std::shared_ptr<const Model> model, GeometryCache& cache, ExpansionCounts& counts)
      : ModelRoot(model_bounds(*model)), model_(std::move(model)), cache_(cache), counts_(counts) {}

  void intersect(RayContext& context, RTCRayHit& ray) const override {
    if (CellEntry* cell = root()) intersect_cell(*cell, context, ray);
  }
  void occluded(RayContext& context, RTCRay& ray) const override {
    if (CellEntry* cell = root()) occluded_cell(*cell, context, ray);
  }

  CellEntry* root() const {
    return static_cast<CellEntry*>(cache_.acquire(slot_, nullptr, [this] {
      return make_entry([this] { return root_cell(*model_); }, 0, bounds(), hash_text(model_->name()));
    }));
  }
  CellEntry* child(CellEntry& parent, std::size_t index) const {
    return static_cast<CellEntry*>(cache_.acquire(parent.slot(index), &parent, [this, &parent, index] {
      const InnerCell& inner = parent.inner();
      auto entry = make_entry([&] { return child_cell(*model_, inner, index); }, inner.level, inner.child_bounds[index],
                              inner.child_keys[index]);
      parent.proxies().tighten(index, static_cast<const CellEntry&>(*entry).real_bounds());
      return entry;
    }));
  }

  static void intersect_cell(CellEntry& cell, RayContext& context, RTCRayHit& ray) {
    if (cell.is_leaf())
      intersect_patch(cell.patch(), cell.key(), context, ray);
    else
      rtcIntersect1(cell.proxies().scene(), &context.embree, &ray);
  }
  static void occluded_cell(CellEntry& cell, RayContext& context, RTCRay& ray) {
    rtcOccluded1(cell.is_leaf() ? cell.patch().scene() : cell.proxies().scene(), &context.embree, &ray);
  }

  const GeometryCache& cache() const { return cache_; }

 private:
  // Never throws: a cell that cannot be expanded becomes its box, once, counted and reported.
  template <class Cut>
  std::unique_ptr<CacheEntry> make_entry(const Cut& cut, int level, const Bounds3f& bounds, Key key) const {
    try {
      const double start_s = counts_.now_s();
      CellMesh mesh = cut();
      const std::int32_t symbol = mesh.mesh.origins[mesh.mesh.face_origins[0]].symbol;
      Expansion expansion = expand(*model_, std::move(mesh), level);
      const double built_from_s = counts_.now_s();
      auto entry = entry_of(expansion, bounds, key);
      const Bounds3f& real_bounds = static_cast<const CellEntry&>(*entry).real_bounds();
      counts_.add({*model_, level, key, symbol, expansion, start_s, built_from_s, bounds, real_bounds}, *entry);
      return entry;
    } catch (const std::exception& error) {
      counts_.add_defect(fmt::format("a cell of model \"{}\" could not be expanded: {}", model_->name(), error.what()));
      return std::make_unique<CellEntry>(SurfacePatch::make_isolated(box_of(bounds, key)), key);
    }
  }

  std::unique_ptr<CacheEntry> entry_of(Expansion& expansion, const Bounds3f& bounds, Key key) const {
    if (!expansion.leaf) {
      std::unique_ptr<CacheEntry> entry;
      run_isolated([&] { entry = std::make_unique<CellEntry>(*this, std::move(expansion.inner)); });
      return entry;
    }
    if (!bounds.contains(expansion.leaf->bounds()))
      counts_.add_defect(fmt::format("a cell of model \"{}\" left its bounds", model_->name()));
    return std::make_unique<CellEntry>(SurfacePatch::make_isolated(std::move(*expansion.leaf)), key);
  }

  std::shared_ptr<const Model> model_;
  GeometryCache& cache_;
  ExpansionCounts& counts_;
  mutable CacheSlot slot_;
};

// Embree's callbacks for child cells. acquire() does not throw, so nothing crosses the C boundary.
CellEntry& owner(void* proxies) { return *static_cast<CellEntry*>(static_cast<ProxyScene*>(proxies)->user()); }

void intersect_child(const RTCIntersectFunctionNArguments* args) {
  if (!args->valid[0]) return;
  CellEntry& parent = owner(args->geometryUserPtr);
  auto& context = *reinterpret_cast<RayContext*>(args->context);
  if (CellEntry* cell = parent.root().child(parent, args->primID)) {
    if (context.visits) ++context.visits[cell->label.cell_class];
    LazyRoot::intersect_cell(*cell, context, *reinterpret_cast<RTCRayHit*>(args->rayhit));
  }
}

void occluded_child(const RTCOccludedFunctionNArguments* args) {
  if (!args->valid[0]) return;
  CellEntry& parent = owner(args->geometryUserPtr);
  auto& context = *reinterpret_cast<RayContext*>(args->context);
  if (CellEntry* cell = parent.root().child(parent, args->primID)) {
    if (context.visits) ++context.visits[cell->label.cell_class];
    LazyRoot::occluded_cell(*cell, context, *reinterpret_cast<RTCRay*>(args->ray));
  }
}

CellEntry::CellEntry(const LazyRoot& root, std::unique_ptr<InnerCell> inner)
    : root_(&root), inner_(std::move(inner)), slots_(std::make_unique<CacheSlot[]>(inner_->child_count())) {
  for (const Bounds3f& b : inner_->child_bounds) real_bounds_.extend(b);
  proxies_ =
      std::make_unique<ProxyScene>(inner_->child_bounds, ProxyScene::Callbacks{this, intersect_child, occluded_child});
  bytes = proxies_->bytes() + inner_->bytes() + inner_->child_count() * sizeof(CacheSlot) + sizeof(*this);
  label.tree_bytes = proxies_->bytes();
}

}  // namespace

std::unique_ptr<ModelRoot> make_lazy_root(std::shared_ptr<const Model> model, GeometryCache& cache,
                                          ExpansionCounts& counts) {
  return std::make_unique<LazyRoot>(std::move(model), cache, counts);
}

void expand_everything(const ModelRoot& lazy_root, int threads) {
  const auto& root = static_cast<const LazyRoot&>(lazy_root);
  std::vector<CellEntry*> generation{root.root()};
  while (!generation.empty()) {
    // All children of this generation's cells, one work item each
    std::vector<std::pair<CellEntry*, std::size_t>> children;
    for (CellEntry* cell : generation)
      if (cell && !cell->is_leaf())
        for (std::size_t i = 0; i < cell->inner().child_count(); ++i) children.push_back({cell, i});
    std::vector<CellEntry*> next(children.size());
    std::atomic<std::size_t> counter{0};
    run_threads(threads, [&](int) {
      for (std::size_t i; (i = counter.fetch_add(1)) < children.size();)
        next[i] = root.child(*children[i].first, children[i].second);
    });
    generation = std::move(next);
  }
}

}  // namespace meristem
