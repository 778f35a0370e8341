// What the analysis of bounds needs to know of groups of faces and their surroundings. A ring is the faces that share a
// vertex with what it lies around.
#pragma once

#include "geometry/base/bounds.h"
#include "geometry/mesh/mesh.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace meristem {

// Of all faces within one ring; joined by union.
struct Ring1 {
  Bounds3d box;
  Bounds3d refined_box;  // after one step of Catmull-Clark, of which a ring is half as wide
  double contraction = 0;

  void join(const Ring1& b) {
    box.extend(b.box);
    refined_box.extend(b.refined_box);
    contraction = std::max(contraction, b.contraction);
  }
};

// And within two.
struct Ring2 {
  double edge = 0;
  Vec2d lower_uv{INFINITY, INFINITY}, upper_uv{-INFINITY, -INFINITY};

  void join(const Ring2& b) {
    edge = std::max(edge, b.edge);
    lower_uv = {std::min(lower_uv.x, b.lower_uv.x), std::min(lower_uv.y, b.lower_uv.y)};
    upper_uv = {std::max(upper_uv.x, b.upper_uv.x), std::max(upper_uv.y, b.upper_uv.y)};
  }
};

struct GroupRings {
  std::vector<Ring1> ring1;  // by group
  std::vector<Ring2> ring2;
};

// `group_of` names the groups of a mesh's first faces; the others are their halo. Linear in the mesh.
GroupRings rings_of_groups(const Mesh& mesh, std::span<const std::uint32_t> group_of, std::size_t group_count);

}  // namespace meristem
