#include "geometry/accel/roots.h"

#include "geometry/cells/expansion.h"
#include "geometry/cells/placed_footprint.h"

#include <limits>

namespace meristem {

namespace {

// Those of the very individual, where they can be had before it is expanded. Most of what is placed is never met: so
// not from all that grows on it. The twigs of a tree are many and reach little beyond its branches.
void find_bounds(RootSource& source) {
  constexpr int derived_levels = 2;
  if (source.part->derives)
    source.bounds = model_bounds(*source.part->model, source.footprint.get(), source.individual, derived_levels);
}

}  // namespace

// Where nothing is evicted it need not be kept.
std::size_t Roots::most_known_bytes(const GeometryCache& cache) {
  constexpr std::size_t share = 16;
  return cache.budget_bytes() == std::numeric_limits<std::size_t>::max() ? 0 : cache.budget_bytes() / share;
}

std::unique_ptr<ModelRoot> Roots::make(RootSource source) {
  const bool is_surface = source.part->model && !source.part->placer;
  if (mode_ == ExpandMode::Flat && is_surface) return make_flat_root(source, counts_, threads_);
  return make_lazy_root(std::move(source), *this, cache_, counts_, scratch_);
}

const ModelRoot& Roots::shared(RootSource source) {
  const std::lock_guard lock(mutex_);
  std::unique_ptr<ModelRoot>& root =
      shared_[{source.part.get(), source.individual, constant_size(source.footprint.get())}];
  if (!root) {
    constexpr std::size_t node_bytes = 96;  // of the map
    find_bounds(source);
    root = make(std::move(source));
    bytes_ += root->bytes() + node_bytes;
  }
  return *root;
}

const ModelRoot& Roots::root_of(const Placement& shown, std::shared_ptr<const Footprint> seen_as, Key individual,
                                Key moment, Owner& owner) {
  RootSource source{shown.part, std::move(seen_as),   placed_individual(individual, shown),
                    nullptr,    placed_bounds(shown), moment};
  if (can_share(shown, source.footprint.get())) return shared(std::move(source));
  find_bounds(source);
  source.parent = owner.parent;
  owner.roots.push_back(make(std::move(source)));
  return *owner.roots.back();
}

std::unique_ptr<Instances> Roots::place(const std::vector<Placement>& placements,
                                        const std::shared_ptr<const Footprint>& footprint, CacheEntry* parent,
                                        Key individual, bool are_objects) {
  std::vector<Instance> instances;
  std::vector<Bounds3f> bounds;
  std::vector<const ModelRoot*> roots;
  Owner owner{parent, {}};
  instances.reserve(placements.size());
  bounds.reserve(placements.size());
  for (const Placement& placed : placements) {
    auto [p, seen_as] = shown_placement(placed, footprint);
    roots.assign(1, &root_of(p, std::move(seen_as), individual, 0, owner));
    for (std::size_t moment = 1; p.moments && moment < p.moments->size(); ++moment) {
      p.part = (*p.moments)[moment];
      roots.push_back(&root_of(p, placed_footprint(footprint, p), individual, moment, owner));
    }
    instances.emplace_back(roots, p);
    bounds.push_back(instance_bounds(roots, p));
  }
  return std::make_unique<Instances>(std::move(instances), bounds, std::move(owner.roots), are_objects);
}

}  // namespace meristem
