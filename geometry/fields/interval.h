// Bounds of an expression over intervals of its inputs: sound for every float that the kernels can give (rounded
// outwards by several ulps), sharp for monotone functions and for single occurrences of a variable. Cost: some tens of
// nanoseconds a node, a few hundred for a noise.
#pragma once

#include "geometry/fields/graph.h"

#include <span>

namespace meristem {

// One interval a slot; see Expression::evaluate_bounds.
IntervalValue bounds_of(const Graph& graph, NodeId result, std::span<const IntervalValue> inputs);

}  // namespace meristem
