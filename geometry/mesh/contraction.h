// How much the longest edge of a region can grow under one smoothing step: what bounds displacement by local scale.
#pragma once

#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/refine_plan.h"

namespace meristem {

// A bound on |edge after| / (longest edge before) for the edges that meet in vertex v after one Catmull-Clark step, and
// later ones there. Before: edges of length at most 1 if every face around v is a quad; otherwise corners of a face at
// distance at most 1.
//
// Quads: with v at the origin, write the refined vertex and the new edge points as combinations of the edges p_i at v
// and the edges t opposite to them (f_i = 3/8 (p_i + p_i+1) + (t_i + t'_i)/8). The bound is the sum of the absolute
// coefficients of the difference; edges from an edge point to a face point are at most 1/2 long.
double smoothing_contraction(const Adjacency& adjacency, std::uint32_t v);

// The same for a vertex inside, with `valence` quads around it and no creases.
double smooth_contraction(std::uint32_t valence);

// The same for vertices with any faces around them, known only by valence.
double general_contraction(std::uint32_t valence);

}  // namespace meristem
