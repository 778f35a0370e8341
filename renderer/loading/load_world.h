// The section "objects" of a scene file: which models stand where.
#pragma once

#include "geometry/accel/world.h"
#include "renderer/loading/load_model.h"

namespace meristem {

struct ObjectSection {
  std::string model;
  int seed = 0;
  Affine3d to_world;
};
ObjectSection read_object(Params& params);

// Builds every model that an object names (once for each seed), and places the objects. `models` and `objects` are the
// sections as written; null if absent.
std::vector<WorldObject> build_objects(const Value* models, const Value* objects, const ModelContext& context);

}  // namespace meristem
