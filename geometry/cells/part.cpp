#include "geometry/cells/part.h"

#include "geometry/cells/expansion.h"

namespace meristem {

namespace {

Bounds3f group_bounds(const std::vector<Placement>& members) {
  Bounds3f bounds;
  for (const Placement& m : members) {
    const Bounds3f& b = m.part->bounds;
    if (!b.empty()) bounds.extend(round_outwards(m.to_parent.bounds(Bounds3d{Vec3d(b.lower), Vec3d(b.upper)})));
  }
  return bounds;
}

}  // namespace

Bounds3f bounds_with_reach(const Bounds3f& ground, const Bounds3f& reach) {
  if (ground.empty() || reach.empty()) return ground;
  return {ground.lower + reach.lower, ground.upper + reach.upper};
}

Part::Part(std::shared_ptr<const Model> shown)
    : model(std::move(shown)),
      bounds(model_bounds(*model)),
      derives(model->levels() > 0 && model->step(0).grows(model->base().mesh.origins[0].symbol) &&
              model->step(0).derive(model->base(), 0, 1)),
      typical(derives ? model_bounds(*model, nullptr, 0, model->levels()) : bounds) {}

Part::Part(std::shared_ptr<const Model> ground, std::shared_ptr<const Placer> on_it)
    : model(std::move(ground)),
      placer(std::move(on_it)),
      bounds(bounds_with_reach(model_bounds(*model), placer->reach())),
      typical(bounds) {}

Part::Part(std::vector<Placement> group) : members(std::move(group)), bounds(group_bounds(members)), typical(bounds) {}

}  // namespace meristem
