#include "geometry/mesh/contraction.h"

#include <algorithm>
#include <cmath>

namespace meristem {

double general_contraction(std::uint32_t valence) { return 0.75 + 2.0 / std::max(3u, valence); }

double smooth_contraction(std::uint32_t valence) {
  // Regular: a tensor product of cubic B-splines, where every new edge is a convex combination of old ones of its
  // direction, halved.
  if (valence == 4) return 0.5;
  const double n = valence;
  const double p = 1.75 / (n * n), t = 0.125 / (n * n);  // coefficients of every p_i and t_i in the refined vertex
  return std::abs(7.0 / 16 - p) + 2 * std::abs(3.0 / 32 - p) + (n - 3) * p + 4 * std::abs(1.0 / 32 - t) +
         (2 * n - 4) * t;
}

double smoothing_contraction(const Adjacency& adjacency, std::uint32_t v) {
  const auto edges = adjacency.edges_of_vertex(v);
  int sharp = 0;
  for (std::uint32_t e : edges)
    sharp += adjacency.edge(e).sharpness > 0 || adjacency.edge(e).faces[1] == Adjacency::none;
  // An edge point is at most 3/4 away from its end; the refined vertex of a crease moves by at most 1/4, of a corner
  // not at all. A boundary with two quads, where the crease is shared with the neighbours of the one inner edge: 7/16 +
  // 2/32 + 4/32.
  if (sharp == 2 && edges.size() == 3) return 0.625;
  if (sharp > 0) return 1.0;
  return smooth_contraction(std::uint32_t(edges.size()));
}

}  // namespace meristem
