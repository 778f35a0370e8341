#include "geometry/cells/placed_footprint.h"

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

// Constant footprints that are shared come in steps of this factor.
constexpr double footprint_steps_per_octave = 2;
// A footprint that varies by less than this factor over a part counts as constant there.
constexpr double most_variation = 1.5;

const ConstantFootprint* as_constant(const Footprint* footprint) {
  return dynamic_cast<const ConstantFootprint*>(footprint);
}

}  // namespace

const Bounds3f& placed_bounds(const Placement& p) { return p.known_bounds.empty() ? p.part->typical : p.known_bounds; }

std::shared_ptr<const Footprint> placed_footprint(const std::shared_ptr<const Footprint>& parent,
                                                  const Placement& placement) {
  if (!parent || placement.in_full) return nullptr;
  auto exact = std::make_shared<ObjectFootprint>(parent, placement.to_parent);
  const Bounds3f& bounds = placed_bounds(placement);
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

Placement shown_placement(const Placement& placement, const std::shared_ptr<const Footprint>& footprint) {
  if (placement.stand_in == 0) return placement;
  Placement other = placement;
  other.individual = placement.stand_in;
  other.is_shared = true;
  const double size = constant_size(placed_footprint(footprint, other).get());
  return max_component(placed_bounds(placement).size()) < placement.stand_in_below * size ? other : placement;
}

Key placed_individual(Key parent, const Placement& placement) {
  if (placement.individual == 0) return parent;
  return parent == 0 ? placement.individual : hash_keys(parent, placement.individual);
}

bool can_share(const Placement& placement, const Footprint* footprint) {
  return placement.is_shared && (!footprint || as_constant(footprint));
}

double constant_size(const Footprint* footprint) {
  const ConstantFootprint* constant = as_constant(footprint);
  return constant ? constant->at({}) : 0;
}

}  // namespace meristem
