// What can be told of a model's derivation before anything grows, from the rules alone; for the loader.
#pragma once

#include "geometry/base/source.h"
#include "geometry/cells/model.h"

#include <memory>
#include <span>

namespace meristem {

// How many faces the model will have after all steps: the expected number where weights are constant and conditions
// certain, else an upper bound. `extent`: that of the whole base mesh. Cheap: grows with the number of steps and rules,
// not with the faces.
double estimated_faces(const Mesh& base, const Extent& extent, std::span<const std::unique_ptr<Step>> steps);

// The same of a model that has been made, and of trees of Weber and Penn about as many.
double expected_faces(const Model& model);

// Reports every production whose template cannot stand on a face that it may meet (a fork on a triangle), following the
// symbols from the base mesh through all steps; conditions are taken to hold. And the scheme loop on faces of the base,
// or of Catmull-Clark, that are no triangles, at the place of its step; behind growth, which may replace all of them,
// that is not known here. `places`: of the steps in the file.
void check_corner_counts(const Mesh& base, std::span<const std::unique_ptr<Step>> steps,
                         std::span<const Location> places, Diagnostics& diagnostics);

}  // namespace meristem
