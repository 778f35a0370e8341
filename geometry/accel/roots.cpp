#include "geometry/accel/roots.h"

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

// Constant footprints that are shared come in steps of this factor.
constexpr double footprint_steps_per_octave = 2;
// A footprint that varies by less than this factor over a part counts as constant there.
constexpr double most_variation = 1.5;

const Bounds3f& bounds_of(const Placement& p) { return p.known_bounds.empty() ? p.part->bounds : p.known_bounds; }

// The footprint in the frame of a placed part. Where it hardly varies over the part it is constant, the least of it,
// so that other placements can share what is expanded.
std::shared_ptr<const Footprint> placed_footprint(const std::shared_ptr<const Footprint>& parent,
                                                  const Placement& placement) {
  if (!parent || placement.in_full) return nullptr;
  auto exact = std::make_shared<ObjectFootprint>(parent, placement.to_parent);
  const Bounds3f& bounds = bounds_of(placement);
  if (bounds.empty()) return exact;
  double least = exact->at(Vec3d(bounds.center())), most = least;
  for (int i = 0; i < 8; ++i) {
    const double at_corner =
        exact->at({i & 1 ? bounds.upper.x : bounds.lower.x, i & 2 ? bounds.upper.y : bounds.lower.y,
                   i & 4 ? bounds.upper.z : bounds.lower.z});
    least = std::min(least, at_corner);
    most = std::max(most, at_corner);
  }
  if (most > most_variation * least) return exact;
  if (!placement.is_shared) return std::make_shared<ConstantFootprint>(least);
  return std::make_shared<ConstantFootprint>(
      std::exp2(std::floor(std::log2(least) * footprint_steps_per_octave) / footprint_steps_per_octave));
}

}  // namespace

std::unique_ptr<ModelRoot> Roots::make(RootSource source) {
  const bool is_surface = source.part->model && !source.part->placer;
  if (mode_ == ExpandMode::Flat && is_surface) return make_flat_root(source, counts_, threads_);
  return make_lazy_root(std::move(source), *this, cache_, counts_);
}

const ModelRoot& Roots::shared(RootSource source, const Placement& placement) {
  const auto* constant = dynamic_cast<const ConstantFootprint*>(source.footprint.get());
  const std::lock_guard lock(mutex_);
  std::unique_ptr<ModelRoot>& root =
      shared_[{placement.part.get(), source.individual, constant ? constant->at({}) : 0}];
  if (!root) root = make(std::move(source));
  return *root;
}

std::unique_ptr<Instances> Roots::place(const std::vector<Placement>& placements,
                                        const std::shared_ptr<const Footprint>& footprint, CacheEntry* parent,
                                        Key individual, bool are_objects) {
  std::vector<Instance> instances;
  std::vector<std::unique_ptr<ModelRoot>> owned;
  instances.reserve(placements.size());
  for (const Placement& p : placements) {
    const Key own = p.individual == 0 ? individual
                    : individual == 0 ? p.individual
                                      : hash_keys(individual, p.individual);
    RootSource source{p.part, placed_footprint(footprint, p), own, nullptr, bounds_of(p)};
    const bool can_share =
        p.is_shared && (!source.footprint || dynamic_cast<const ConstantFootprint*>(source.footprint.get()));
    const ModelRoot* root = nullptr;
    if (can_share) {
      root = &shared(std::move(source), p);
    } else {
      source.parent = parent;
      owned.push_back(make(std::move(source)));
      root = owned.back().get();
    }
    const auto index = instances.size();
    instances.emplace_back(*root, bounds_of(p), p.to_parent, Key(index) + 1, are_objects ? int(index) : -1);
  }
  return std::make_unique<Instances>(std::move(instances), std::move(owned));
}

}  // namespace meristem
