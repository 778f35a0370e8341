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

Part::Part(std::shared_ptr<const Model> shown) : model(std::move(shown)), bounds(model_bounds(*model)) {}

Part::Part(std::shared_ptr<const Model> ground, std::shared_ptr<const Placer> on_it)
    : model(std::move(ground)),
      placer(std::move(on_it)),
      bounds(model_bounds(*model).inflated(Vec3f(float(placer->reach())))) {}

Part::Part(std::vector<Placement> group) : members(std::move(group)), bounds(group_bounds(members)) {}

}  // namespace meristem
