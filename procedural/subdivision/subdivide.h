// The step object `{"subdivide": 3, "place": "...", ...}` of a scene file.
#pragma once

#include "procedural/subdivision/subdivide_step.h"

#include "geometry/base/params.h"

#include <memory>
#include <vector>

namespace meristem {

// One SubdivideStep a level, before the first a DropBorderStep if borders are not to be shown. `first_level` counts the
// model's subdivisions so far, from 1; step_key is the model's seed hashed with the place of the step. In describe mode
// only the parameters are declared.
std::vector<std::unique_ptr<Step>> read_subdivide(Params& params, int first_level, Key step_key);

}  // namespace meristem
