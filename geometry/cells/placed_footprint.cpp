#include "geometry/cells/placed_footprint.h"

#include "geometry/cells/expansion.h"

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

// Seen from the space of an object that moves.
class MovingFootprint final : public Footprint {
 public:
  MovingFootprint(const std::shared_ptr<const Footprint>& parent, const Motion& motion) {
    for (int i = 0; i < times; ++i) at_times_.emplace_back(parent, motion.at(share_of_shutter(i)));
  }
  double at(Vec3d position) const override {
    double least = at(position, 0);
    for (int i = 1; i < times; ++i) least = std::min(least, at(position, i));
    return least;
  }
  double at(Vec3d position, int time) const override { return at_times_[std::size_t(time)].at(position, time); }
  bool fades() const override { return at_times_[0].fades(); }

 private:
  std::vector<ObjectFootprint> at_times_;
};

// As seen from the space of a placed part, `exact`; `keep` makes one that lasts.
template <class Exact, class Keep>
std::shared_ptr<const Footprint> footprint_of(const Exact& exact, const Placement& placement, const Keep& keep) {
  const Bounds3f& bounds = placed_bounds(placement);
  if (bounds.empty() || (exact.fades() && !placement.is_one_of_many)) return keep();
  double least = exact.at(Vec3d(bounds.center())), most = least;
  for (int i = 0; i < 8; ++i) {
    const double at_corner = exact.at({i & 1 ? bounds.upper.x : bounds.lower.x, i & 2 ? bounds.upper.y : bounds.lower.y,
                                       i & 4 ? bounds.upper.z : bounds.lower.z});
    least = std::min(least, at_corner);
    most = std::max(most, at_corner);
    if (!is_about_constant({least, most})) return keep();
  }
  if (!placement.is_shared) return std::make_shared<ConstantFootprint>(least, exact.fades());
  return std::make_shared<ConstantFootprint>(size_of_step(footprint_step(least)), exact.fades());
}

// Of a part that enlarges() as it is seen.
Bounds3f enlarged_bounds(const Part& part, const Footprint* footprint, Key individual) {
  if (part.model && !part.placer) return model_bounds(*part.model, footprint, individual, 0);
  if (part.placer) {
    const Bounds3f ground = model_bounds(*part.model);
    return bounds_with_reach(ground, part.placer->reach_on(ground, footprint, individual)->all);
  }
  Bounds3f bounds;
  const std::shared_ptr<const Footprint> around(std::shared_ptr<const Footprint>(), footprint);
  for (const Placement& m : part.members) {
    const auto seen_as = placed_footprint(around, m);
    const Bounds3f box =
        bounds_of_individual(*m.part, seen_as.get(), placed_individual(individual, m), m.part->typical);
    bounds.extend(bounds_in_parent(m, box));
  }
  return bounds;
}

// A box that reaches as much further as one box does than another.
Bounds3f reaching_further(const Bounds3f& box, const Bounds3f& from, const Bounds3f& to) {
  const Vec3d lower = min(Vec3d(to.lower) - Vec3d(from.lower), Vec3d{});
  const Vec3d upper = max(Vec3d(to.upper) - Vec3d(from.upper), Vec3d{});
  return round_outwards(Bounds3d{Vec3d(box.lower) + lower, Vec3d(box.upper) + upper});
}

}  // namespace

const Bounds3f& placed_bounds(const Placement& p) { return p.known_bounds.empty() ? p.part->typical : p.known_bounds; }

int footprint_step(double size) { return int(std::floor(std::log2(size) * footprint_steps_per_octave)); }

double size_of_step(int step) { return std::exp2(step / footprint_steps_per_octave); }

bool is_about_constant(const Footprint::Range& range) { return range.most <= most_variation * range.least; }

// The twigs of a tree are many and reach little beyond its branches.
Bounds3f bounds_of_individual(const Part& part, const Footprint* footprint, Key individual, const Bounds3f& otherwise) {
  constexpr int derived_levels = 2;
  if (part.derives) {
    const auto derive = [&] { return model_bounds(*part.model, footprint, individual, derived_levels); };
    const ConstantFootprint* const seen_as = as_constant(footprint);
    return seen_as ? part.individual_bounds.get({individual, seen_as->at({}), seen_as->fades()}, derive) : derive();
  }
  if (!part.enlarges || !footprint) return otherwise;
  return reaching_further(otherwise, part.typical, enlarged_bounds(part, footprint, individual));
}

std::shared_ptr<const Footprint> placed_footprint(const std::shared_ptr<const Footprint>& parent,
                                                  const Placement& placement) {
  if (!parent || placement.in_full) return nullptr;
  if (placement.motion) {
    const auto exact = std::make_shared<MovingFootprint>(parent, *placement.motion);
    return footprint_of(*exact, placement, [&] { return exact; });
  }
  const ObjectFootprint exact(parent, placement.to_parent);
  return footprint_of(exact, placement, [&] { return std::make_shared<ObjectFootprint>(exact); });
}

ShownPlacement shown_placement(const Placement& placement, const std::shared_ptr<const Footprint>& footprint) {
  if (placement.stand_in == 0) return {placement, placed_footprint(footprint, placement)};
  Placement other = placement;
  other.individual = placement.stand_in;
  other.is_shared = true;
  other.is_one_of_many = true;
  auto seen_as = placed_footprint(footprint, other);
  const double size = constant_size(seen_as.get());
  if (max_component(placed_bounds(placement).size()) < placement.stand_in_below * size)
    return {std::move(other), std::move(seen_as)};
  return {placement, placed_footprint(footprint, placement)};
}

std::optional<SharedPlacement> shared_placement(const Placement& p, const Footprint::Range& parent) {
  const bool is_of_many = p.stand_in != 0 || (p.is_shared && p.is_one_of_many);
  if (!is_of_many || p.in_full || p.motion || p.moments || !is_about_constant(parent)) return {};
  constexpr double rounding = 1e-9;
  const double stretch = largest_stretch(p.to_parent);
  const int step = footprint_step(parent.least / stretch * (1 - rounding));
  if (footprint_step(parent.most / stretch * (1 + rounding)) != step) return {};
  const double size = size_of_step(step);
  if (p.stand_in == 0) return SharedPlacement{p.individual, size};
  if (!(max_component(placed_bounds(p).size()) < p.stand_in_below * size)) return {};
  return SharedPlacement{p.stand_in, size};
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
