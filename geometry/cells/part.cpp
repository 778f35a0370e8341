#include "geometry/cells/part.h"

#include "geometry/cells/expansion.h"

#include <algorithm>

namespace meristem {

namespace {

Bounds3f group_bounds(const std::vector<Placement>& members) {
  Bounds3f bounds;
  for (const Placement& m : members) bounds.extend(bounds_in_parent(m, bounds_of_moments(*m.part, m.moments.get())));
  return bounds;
}

// What of its bounds are, if nothing is enlarged.
Bounds3f group_in_full(const std::vector<Placement>& members) {
  Bounds3f bounds;
  for (const Placement& m : members)
    bounds.extend(
        bounds_in_parent(m, m.part->enlarges ? m.part->typical : bounds_of_moments(*m.part, m.moments.get())));
  return bounds;
}

// More of them would be asked too often.
constexpr std::size_t most_enlarged_members = 64;

bool group_enlarges(const std::vector<Placement>& members) {
  const auto derives = [](const Placement& m) { return m.part->derives || m.moments; };
  const auto enlarges = [](const Placement& m) { return m.part->enlarges; };
  return members.size() <= most_enlarged_members && std::ranges::none_of(members, derives) &&
         std::ranges::any_of(members, enlarges);
}

}  // namespace

Bounds3f bounds_in_parent(const Placement& placement, const Bounds3f& box) {
  if (box.empty()) return box;
  const Bounds3d exact{Vec3d(box.lower), Vec3d(box.upper)};
  return round_outwards(placement.motion ? placement.motion->bounds(exact) : placement.to_parent.bounds(exact));
}

Bounds3f bounds_of_moments(const Part& part, const PartMoments* moments) {
  Bounds3f bounds = part.bounds;
  if (moments)
    for (const auto& moment : *moments) bounds.extend(moment->bounds);
  return bounds;
}

Bounds3f bounds_with_reach(const Bounds3f& ground, const Bounds3f& reach) {
  if (ground.empty() || reach.empty()) return ground;
  return {ground.lower + reach.lower, ground.upper + reach.upper};
}

Part::Part(std::shared_ptr<const Model> shown)
    : model(std::move(shown)),
      bounds(model_bounds(*model)),
      derives(model->levels() > 0 && model->step(0).grows(model->base().mesh.origins[0].symbol) &&
              model->step(0).derive(model->base(), 0, 1)),
      enlarges(!derives && model->enlarges_later(0)),
      typical(derives || enlarges ? model_bounds(*model, nullptr, 0, model->levels()) : bounds) {}

Part::Part(std::shared_ptr<const Model> ground, std::shared_ptr<const Placer> on_it)
    : model(std::move(ground)),
      placer(std::move(on_it)),
      bounds(bounds_with_reach(model_bounds(*model), placer->reach())),
      enlarges(placer->enlarges()),
      typical(enlarges ? bounds_with_reach(model_bounds(*model), placer->typical_reach()) : bounds) {}

Part::Part(std::vector<Placement> group)
    : members(std::move(group)),
      bounds(group_bounds(members)),
      enlarges(group_enlarges(members)),
      typical(enlarges ? group_in_full(members) : bounds) {}

}  // namespace meristem
