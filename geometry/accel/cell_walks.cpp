// What goes through the cells of lazy roots by itself, without a ray.
#include "geometry/accel/lazy_root.h"
#include "geometry/base/parallel.h"
#include "geometry/cells/level_of_detail.h"

#include <atomic>
#include <functional>
#include <set>

namespace meristem {

namespace {

// Calls ends(cell) for each resident cell from `cell` on that holds a surface or instances, and missing(parent, child)
// for what is not resident.
template <class Ends, class Missing>
void for_each_end(CellEntry& cell, const Ends& ends, const Missing& missing) {
  if (!cell.has_proxies()) return ends(cell);
  for (std::uint32_t i = 0; i < cell.child_count(); ++i) {
    if (CellEntry* const child = cell.root().found(cell.slot(i)))
      for_each_end(*child, ends, missing);
    else
      missing(cell, i);
  }
}

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
    if (cell.has_proxies())
      if (CellEntry* child = cell.root().child(cell, largest_child(cell))) most = below(*child);
    return cell.bytes + most;
  }
  static std::size_t largest_child(const CellEntry& cell) {
    if (const Grove* grove = cell.grove()) return largest_group(*grove);
    const InnerCell& inner = *cell.inner();
    const CellMesh whole = inner.whole();
    std::size_t largest = 0;
    double most = -1;
    for (std::size_t i = 0; i < inner.child_count(); ++i) {
      double faces = 0;
      for (std::uint32_t f : inner.faces_of_child(i)) faces += wanted_faces(cell.root().model(), whole, f, inner.level);
      if (faces > most) most = faces, largest = i;
    }
    return largest;
  }

  static std::size_t largest_group(const Grove& grove) {
    std::size_t largest = 0;
    for (std::size_t i = 1; i < grove.bounds().size(); ++i)
      if (grove.most_in(i) > grove.most_in(largest)) largest = i;
    return largest;
  }

  std::set<const Part*> seen_;
};

}  // namespace

void LazyRoot::add_placed(std::vector<const ModelRoot*>& roots) const {
  CellEntry* const cell = found(slot_);
  if (!cell) return;
  const auto add = [&](const CellEntry& end) {
    const Instances* const placed = end.instances();
    for (std::uint32_t i = 0; placed && i < placed->count(); ++i) placed->instance(i).add_roots(roots);
  };
  for_each_end(*cell, add, [](const CellEntry&, std::uint32_t) {});
}

std::size_t LazyRoot::braid() const {
  CellEntry* const cell = found(slot_);
  if (!cell) return 0;
  if (const SurfacePatch* const patch = cell->patch()) {
    if (!patch->tree().nodes().empty()) lone_.emplace(*patch, cell->key());
    return 0;
  }
  // Instances may be a million
  std::size_t placed = 0;
  const auto count = [&](const CellEntry& end) { placed += end.instances() ? end.instances()->count() : 0; };
  for_each_end(*cell, count, [](const CellEntry&, std::uint32_t) {});
  BraidedCells::Strands strands;
  strands.placed.reserve(placed);
  const auto add = [&](const CellEntry& end) {
    if (end.patch())
      strands.surfaces.push_back({end.patch(), end.key()});
    else
      strands.add(*end.instances());
  };
  for_each_end(*cell, add, [&](CellEntry& parent, std::uint32_t child) {
    strands.missing.push_back({parent.contents(), child, parent.proxies().bounds(child)});
  });
  braided_ = std::make_unique<const BraidedCells>(std::move(strands));
  known_bounds_ = braided_->bounds();
  return braided_->bytes();
}

const Passage* LazyRoot::passage() const {
  if (lone_) return &*lone_;
  return braided_ && !braided_->empty() ? braided_.get() : nullptr;
}

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
      for (std::size_t i = 0; i < cell->child_count(); ++i)
        generation.push_back([cell, i] { return cell->root().child(*cell, i); });
      if (cell->instances())
        for (const ModelRoot* root : cell->instances()->roots()) add_root(root);
    }
  }
}

}  // namespace meristem
