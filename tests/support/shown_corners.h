// The triangles that a model comes to, with all that a hit reads of them, however it is cut into cells.
#pragma once

#include "geometry/cells/expansion.h"
#include "geometry/cells/uv_packing.h"

#include <algorithm>
#include <array>
#include <vector>

namespace meristem {

// Position, normal, u and v, of the three corners.
using ShownCorners = std::array<std::array<float, 8>, 3>;

inline void collect_corners(const Model& model, CellMesh cell, int level, std::vector<ShownCorners>& triangles,
                            int& leaves) {
  const Expansion e = expand(model, std::move(cell), level);
  for (std::size_t i = 0; e.inner && i < e.inner->child_count(); ++i)
    collect_corners(model, child_cell(model, *e.inner, i), e.inner->level, triangles, leaves);
  if (!e.leaf) return;
  ++leaves;
  const std::vector<Vec2f> uv = vertex_uv(*e.leaf);
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    ShownCorners triangle;
    std::size_t k = 0;
    for (const std::uint32_t v : {a, b, c}) {
      const Vec3f p = e.leaf->positions[v], n = e.leaf->attributes[v].normal.unpack();
      triangle[k++] = {p.x, p.y, p.z, n.x, n.y, n.z, uv[v].x, uv[v].y};
    }
    const auto place = [&](std::size_t i) { return std::array{triangle[i][0], triangle[i][1], triangle[i][2]}; };
    if (place(0) != place(1) && place(1) != place(2) && place(2) != place(0)) triangles.push_back(triangle);
  };
  for (const auto& g : e.leaf->grids)
    for (std::uint32_t j = 0; j + 1 < g.height; ++j)
      for (std::uint32_t i = 0; i + 1 < g.width; ++i) {
        const std::uint32_t v = g.first_vertex + j * g.width + i;
        add(v, v + 1, v + g.width);
        add(v + g.width + 1, v + g.width, v + 1);
      }
  for (const auto& t : e.leaf->triangles) add(t[0], t[1], t[2]);
}

// Sorted; those of no extent are left out. Corners stand in the order in which rays meet them.
inline std::vector<ShownCorners> shown_corners(const Model& model, const Footprint* footprint, int* leaves = nullptr) {
  std::vector<ShownCorners> triangles;
  int count = 0;
  collect_corners(model, root_cell(model, footprint), 0, triangles, count);
  std::ranges::sort(triangles);
  if (leaves) *leaves = count;
  return triangles;
}

}  // namespace meristem
