#include "geometry/accel/roots.h"

#include "geometry/cells/placed_footprint.h"

namespace meristem {

std::unique_ptr<ModelRoot> Roots::make(RootSource source) {
  const bool is_surface = source.part->model && !source.part->placer;
  if (mode_ == ExpandMode::Flat && is_surface) return make_flat_root(source, counts_, threads_);
  return make_lazy_root(std::move(source), *this, cache_, counts_);
}

const ModelRoot& Roots::shared(RootSource source, const Placement& placement) {
  const std::lock_guard lock(mutex_);
  std::unique_ptr<ModelRoot>& root =
      shared_[{placement.part.get(), source.individual, constant_size(source.footprint.get())}];
  if (!root) {
    constexpr std::size_t node_bytes = 96;  // of the map
    root = make(std::move(source));
    bytes_ += root->bytes() + node_bytes;
  }
  return *root;
}

std::unique_ptr<Instances> Roots::place(const std::vector<Placement>& placements,
                                        const std::shared_ptr<const Footprint>& footprint, CacheEntry* parent,
                                        Key individual, bool are_objects) {
  std::vector<Instance> instances;
  std::vector<std::unique_ptr<ModelRoot>> owned;
  instances.reserve(placements.size());
  for (const Placement& p : placements) {
    RootSource source{p.part, placed_footprint(footprint, p), placed_individual(individual, p), nullptr,
                      placed_bounds(p)};
    const ModelRoot* root = nullptr;
    if (can_share(p, source.footprint.get())) {
      root = &shared(std::move(source), p);
    } else {
      source.parent = parent;
      owned.push_back(make(std::move(source)));
      root = owned.back().get();
    }
    const auto index = instances.size();
    instances.emplace_back(*root, placed_bounds(p), p.to_parent, Key(index) + 1, are_objects ? int(index) : -1);
  }
  return std::make_unique<Instances>(std::move(instances), std::move(owned));
}

}  // namespace meristem
