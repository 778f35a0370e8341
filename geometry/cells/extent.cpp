#include "geometry/cells/extent.h"

#include <algorithm>

namespace meristem {

namespace {

// Sums of the absolute coefficients by which the vertices of a mesh enter a mean diagonal and an edge of the mesh
// smoothed once (Catmull-Clark; the supremum over valences and creases, and the value for valence 4). A displacement of
// length d of the vertices changes these by at most so many d. Faces that are not quads: twice the weight 1.
constexpr double worst_scale_weight = 1.19, regular_scale_weight = 0.985;
constexpr double worst_edge_weight = 1.25, regular_edge_weight = 0.75;

struct Weights {
  double scale, edge;
};

Weights weights_for(double contraction) {
  if (contraction <= regular_contraction) return {regular_scale_weight, regular_edge_weight};
  if (contraction <= worst_contraction) return {worst_scale_weight, worst_edge_weight};
  return {2, 2};
}

// A bound on (mean diagonal after) / (longest edge before): edges from edge points to face points are at most half an
// edge before (a whole one where faces are not quads), those from refined vertices to edge points `contraction` of it.
double scale_by_edge(double contraction) {
  const double half = contraction > worst_contraction ? 1.0 : 0.5;
  return (3 * half + contraction) / 2;
}

}  // namespace

void Extent::forget_shape() {
  edge_sum = 2 * edge;
  contraction = std::max(contraction, worst_contraction);
  next_contraction = std::max(next_contraction, worst_contraction);
}

double Extent::refined_scale() const {
  // In a regular region edges of each direction halve, and a diagonal is at most one of each.
  const double smooth = contraction <= regular_contraction ? edge_sum / 2 : scale_by_edge(contraction) * edge;
  return smooth + scale_by_edge(contraction) * ripple + weights_for(contraction).scale * last_offset;
}

void Extent::refine(Vec3d down, Vec3d up, double longest) {
  box = {smooth_box().lower + down, smooth_box().upper + up};
  refined_box = {};
  ripple = contraction * ripple + weights_for(contraction).edge * last_offset;
  edge_sum = contraction <= regular_contraction ? edge_sum / 2 : 2 * contraction * edge;
  edge *= contraction;
  last_offset = longest;
  contraction = next_contraction;
}

}  // namespace meristem
