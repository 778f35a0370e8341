// The member "counts" of an object: how often each step of its model is repeated, instead of what the model says. So
// one model shows the stages of its own making, or plants of several ages.
#pragma once

#include "geometry/base/params.h"

#include <optional>
#include <vector>

namespace meristem {

// Whole numbers; their ranges are checked where the steps are read.
std::vector<int> read_step_counts(Params& params);

// The model as written, but with these numbers for its first steps. Empty, and an error at the member "counts", if they
// are more than the model has steps.
std::optional<Value> with_step_counts(const Value& model, const std::vector<int>& counts, Params& params);

}  // namespace meristem
