// What a tree is built over, as boxes: a tessellation's triangles, blocks and clusters of blocks.
#pragma once

#include "geometry/base/scratch.h"
#include "geometry/tree/surface_tree.h"

#include <cmath>
#include <cstdint>
#include <span>
#include <xmmintrin.h>

namespace meristem::tree {

// Of x, y, z; the fourth is not used.
struct Box {
  __m128 lower = _mm_set1_ps(INFINITY), upper = _mm_set1_ps(-INFINITY);

  void extend(const Box& b) {
    lower = _mm_min_ps(lower, b.lower);
    upper = _mm_max_ps(upper, b.upper);
  }
  void extend(__m128 p) {
    lower = _mm_min_ps(lower, p);
    upper = _mm_max_ps(upper, p);
  }
  // Half of it.
  float area() const {
    alignas(16) float s[4];
    _mm_store_ps(s, _mm_sub_ps(upper, lower));
    return s[0] * s[1] + s[1] * s[2] + s[2] * s[0];
  }
};

// The box of some vertices, and whether all are numbers.
struct Corners {
  Box box;
  __m128 differences = _mm_setzero_ps();  // of numbers from themselves: NaN if one is not finite

  void add(__m128 p) {
    box.extend(p);
    differences = _mm_add_ps(differences, _mm_sub_ps(p, p));
  }
  bool are_finite() const { return (_mm_movemask_ps(_mm_cmpeq_ps(differences, _mm_setzero_ps())) & 7) == 7; }
};

constexpr std::uint32_t most_children = 8, most_triangles = 8;  // of a node, of a block

// A rectangle of a grid's quads from a vertex on, or a triangle.
struct Source {
  std::uint32_t first;
  std::uint16_t stride;  // 0: a triangle
  std::uint16_t columns, rows;
  std::uint32_t grid;

  bool is_triangle() const { return stride == 0; }
  std::uint32_t blocks() const { return (columns + 1u) / 2 * ((rows + 1u) / 2); }
};

// What trees are built over.
struct Item {
  Box box;
  Source source;

  std::uint32_t weight() const { return source.is_triangle() ? 1 : most_triangles * source.blocks(); }
  __m128 doubled_centroid() const { return _mm_add_ps(box.lower, box.upper); }
};
constexpr std::uint32_t node_weight = most_children * most_triangles;  // what a node above blocks alone holds

// Vertices of a tessellation, as boxes.
class Vertices {
 public:
  explicit Vertices(const Tessellation& t) : t_(t) {}

  Corners corners_of(const Source& s) const {
    Corners corners;
    if (s.is_triangle())
      for (std::uint32_t v : t_.triangles[s.first]) corners.add(position(v));
    else
      for (std::uint32_t j = 0; j <= s.rows; ++j)
        for (std::uint32_t i = 0; i <= s.columns; ++i) corners.add(position(s.first + j * s.stride + i));
    return corners;
  }

 private:
  __m128 position(std::uint32_t v) const { return _mm_loadu_ps(&t_.positions[v].x); }  // and four bytes behind it

  const Tessellation& t_;
};

// Cuts a rectangle into others of so many columns and rows at most, row by row.
template <class Visit>
void cut(const Source& whole, std::uint32_t columns, std::uint32_t rows, const Visit& visit) {
  for (std::uint32_t y = 0; y < whole.rows; y += rows)
    for (std::uint32_t x = 0; x < whole.columns; x += columns)
      visit(Source{whole.first + y * whole.stride + x, whole.stride,
                   std::uint16_t(std::min(columns, whole.columns - x)), std::uint16_t(std::min(rows, whole.rows - y)),
                   whole.grid});
}

// All of a tessellation: of grids clusters of 4 x 2 blocks, which fill a node, or what there is instead; then
// triangles. Blocks and triangles that have a corner which is not a finite number are left out.
class Items {
 public:
  explicit Items(const Tessellation& t) : list_(most_of(t)) {
    const Vertices vertices(t);
    for (std::uint32_t i = 0; i < t.grids.size(); ++i) {
      const Tessellation::Grid& g = t.grids[i];
      const Source quads{g.first_vertex, g.width, std::uint16_t(g.width - 1), std::uint16_t(g.height - 1), i};
      cut(quads, 8, 4, [&](const Source& cluster) {
        if (!add(vertices, cluster)) cut(cluster, 2, 2, [&](const Source& block) { add(vertices, block); });
      });
    }
    for (std::uint32_t i = 0; i < t.triangles.size(); ++i) add(vertices, {i, 0, 1, 1, SurfaceTree::none});
  }
  std::span<Item> span() { return list_.span().first(count_); }

 private:
  static std::size_t most_of(const Tessellation& t) {
    std::size_t most = t.triangles.size();
    for (const Tessellation::Grid& g : t.grids) most += std::size_t(g.width / 2) * std::size_t(g.height / 2);
    return most;
  }
  bool add(const Vertices& vertices, const Source& source) {
    const Corners corners = vertices.corners_of(source);
    if (!corners.are_finite()) return false;
    list_[count_++] = {corners.box, source};
    return true;
  }

  Scratch<Item> list_;
  std::size_t count_ = 0;
};

}  // namespace meristem::tree
