// The final surface of a model, cell by cell, and as a set of quads that does not depend on the cells.
#pragma once

#include "geometry/cells/expansion.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace meristem {

// All leaves of a model, in the order of its cells.
inline void collect_leaves(const Model& model, CellMesh cell, int level, std::vector<Tessellation>& leaves,
                           int& cells) {
  ++cells;
  Expansion e = expand(model, std::move(cell), level);
  if (e.leaf) {
    leaves.push_back(std::move(*e.leaf));
    return;
  }
  for (std::size_t i = 0; i < e.inner->child_count(); ++i)
    collect_leaves(model, child_cell(model, *e.inner, i), e.inner->level, leaves, cells);
}

inline std::vector<Tessellation> leaves_of(const Model& model, int* cells = nullptr) {
  std::vector<Tessellation> leaves;
  int count = 0;
  collect_leaves(model, root_cell(model), 0, leaves, count);
  if (cells) *cells = count;
  return leaves;
}

// A vertex with its normal, so that both must agree where cells meet.
using Corner = std::array<float, 6>;
using Edge = std::pair<Corner, Corner>;

inline Corner corner(const Tessellation& t, std::uint32_t v) {
  const Vec3f p = t.positions[v], n = t.attributes[v].normal.unpack();
  return {p.x, p.y, p.z, n.x, n.y, n.z};
}

// All quads of all grids, each from its smallest corner on, sorted: the surface as a set.
inline std::vector<std::array<Corner, 4>> quads_of(const std::vector<Tessellation>& leaves) {
  std::vector<std::array<Corner, 4>> quads;
  for (const Tessellation& t : leaves)
    for (const auto& g : t.grids)
      for (std::uint32_t j = 0; j + 1 < g.height; ++j)
        for (std::uint32_t i = 0; i + 1 < g.width; ++i) {
          const std::uint32_t a = g.first_vertex + j * g.width + i;
          std::array<Corner, 4> q{corner(t, a), corner(t, a + 1), corner(t, a + g.width + 1), corner(t, a + g.width)};
          std::rotate(q.begin(), std::min_element(q.begin(), q.end()), q.end());
          quads.push_back(q);
        }
  std::sort(quads.begin(), quads.end());
  return quads;
}

// Checks every cell below one: what it grows lies in the bounds its parent gave it.
inline int count_outside(const Model& model, CellMesh cell, int level, const Bounds3f& bounds, int& cells) {
  ++cells;
  Expansion e = expand(model, std::move(cell), level);
  if (e.leaf) return !bounds.contains(e.leaf->bounds());
  int outside = 0;
  for (std::size_t i = 0; i < e.inner->child_count(); ++i)
    outside += count_outside(model, child_cell(model, *e.inner, i), e.inner->level, e.inner->child_bounds[i], cells);
  return outside;
}

}  // namespace meristem
