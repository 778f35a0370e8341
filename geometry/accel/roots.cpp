#include "geometry/accel/roots.h"

#include "geometry/cells/placed_footprint.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace meristem {

namespace {

void find_bounds(RootSource& source) {
  source.bounds = bounds_of_individual(*source.part, source.footprint.get(), source.individual, source.bounds);
}

// Of a footprint over all boxes by which it is decided as what the placements are seen.
Footprint::Range range_around(const std::vector<Placement>& placements, const Footprint& footprint) {
  Bounds3d region;
  double reach = 0;
  for (const Placement& p : placements) {
    const Bounds3f& box = placed_bounds(p);
    const Vec3d corner = max(abs(Vec3d(box.lower)), abs(Vec3d(box.upper)));
    region.extend(p.to_parent.origin);
    reach = std::max(reach, largest_stretch(p.to_parent) * length(corner));
  }
  return region.empty() ? Footprint::Range{} : footprint.range(region.inflated(Vec3d(reach)));
}

}  // namespace

// Where nothing is evicted it need not be kept.
std::size_t Roots::most_known_bytes(const GeometryCache& cache) {
  constexpr std::size_t share = 16;
  return cache.budget_bytes() == std::numeric_limits<std::size_t>::max() ? 0 : cache.budget_bytes() / share;
}

std::unique_ptr<ModelRoot> Roots::make(RootSource source) {
  const bool is_surface = source.part->model && !source.part->placer;
  if (mode_ == ExpandMode::Flat && is_surface) return make_flat_root(source, counts_, uv_readers_, threads_);
  return make_lazy_root(std::move(source), *this, cache_, counts_, scratch_);
}

std::size_t Roots::bucket(const Part* part, Key individual, double size) {
  return hash_keys(std::bit_cast<std::uintptr_t>(part), individual, std::bit_cast<Key>(size)) % buckets;
}

const ModelRoot* Roots::find_shared(const Part* part, Key individual, double size) const {
  const Shared* s = by_bucket_[bucket(part, individual, size)].load(std::memory_order_acquire);
  while (s && !(s->part == part && s->individual == individual && s->size == size)) s = s->next;
  return s ? s->root.get() : nullptr;
}

const ModelRoot& Roots::shared(RootSource source) {
  const Part* const part = source.part.get();
  const Key individual = source.individual;
  const double size = constant_size(source.footprint.get());
  if (const ModelRoot* known = find_shared(part, individual, size)) return *known;
  const std::lock_guard lock(mutex_);
  if (const ModelRoot* known = find_shared(part, individual, size)) return *known;
  find_bounds(source);
  std::atomic<const Shared*>& first = by_bucket_[bucket(part, individual, size)];
  shared_.push_back({part, individual, size, make(std::move(source)), first.load(std::memory_order_relaxed)});
  bytes_ += shared_.back().root->bytes() + sizeof(Shared);
  first.store(&shared_.back(), std::memory_order_release);
  return *shared_.back().root;
}

// If it follows from bounds on the footprint around it; else null.
const ModelRoot* Roots::shared_root_of(const Placement& placed, const Footprint::Range& footprint, bool fades,
                                       Key individual) {
  const std::optional<SharedPlacement> as = shared_placement(placed, footprint);
  if (!as) return nullptr;
  const Key own = individual == 0 ? as->individual : hash_keys(individual, as->individual);
  if (const ModelRoot* known = find_shared(placed.part.get(), own, as->size)) return known;
  return &shared(
      {placed.part, std::make_shared<ConstantFootprint>(as->size, fades), own, nullptr, placed_bounds(placed), 0});
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
                                        Key individual, bool are_objects, std::uint32_t first) {
  std::vector<Instance> instances;
  std::vector<Bounds3f> bounds;
  std::vector<const ModelRoot*> roots;
  Owner owner{parent, {}};
  instances.reserve(placements.size());
  bounds.reserve(placements.size());
  const Footprint::Range around = footprint ? range_around(placements, *footprint) : Footprint::Range{};
  for (const Placement& placed : placements) {
    if (const ModelRoot* root = shared_root_of(placed, around, footprint && footprint->fades(), individual)) {
      roots.assign(1, root);
      instances.emplace_back(roots, placed);
      bounds.push_back(instance_bounds(roots, placed));
      continue;
    }
    auto [p, seen_as] = shown_placement(placed, footprint);
    roots.assign(1, &root_of(p, std::move(seen_as), individual, 0, owner));
    for (std::size_t moment = 1; p.moments && moment < p.moments->size(); ++moment) {
      p.part = (*p.moments)[moment];
      roots.push_back(&root_of(p, placed_footprint(footprint, p), individual, moment, owner));
    }
    instances.emplace_back(roots, p);
    bounds.push_back(instance_bounds(roots, p));
  }
  return std::make_unique<Instances>(std::move(instances), bounds, std::move(owner.roots), are_objects, first);
}

}  // namespace meristem
