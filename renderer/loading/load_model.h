// The section "model" of a scene file: a base mesh and steps.
#pragma once

#include "geometry/base/params.h"
#include "geometry/cells/model.h"
#include "procedural/growth/growth_symbols.h"

#include <functional>
#include <memory>
#include <string>

namespace meristem {

struct ModelSection {
  const Value* base = nullptr;
  std::string material;  // empty: the default
  const Value* steps = nullptr;
};
ModelSection read_model(Params& params);

// What a model needs of the scene around it.
struct ModelContext {
  // Reports unknown names itself; the empty one is the default.
  std::function<int(const std::string& name, const Location& where)> material_index;
  std::string folder;  // of the scene's assets
  Diagnostics& diagnostics;
  CellSettings cells = {};
  int levels = 0;                                              // of the steps, if not all: 0
  ProductionNumber production_number = no_production_numbers;  // by "model/shoot[2]"
  // Told of every model that is built, by its name in the scene.
  std::function<void(const std::string& name, const Model& model)> on_model = nullptr;
};

// Builds the model called `name` in the variant `seed`. Null, with errors in the diagnostics, if it cannot be.
std::shared_ptr<const Model> build_model(const std::string& name, const Value& value, int seed,
                                         const ModelContext& context);

}  // namespace meristem
