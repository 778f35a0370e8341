// The triangles that a model comes to, seen through a footprint, as one surface.
#pragma once

#include "geometry/cells/expansion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <set>

namespace meristem {

// Calls visit(a, b, c) for the corners of every triangle that a model comes to, seen through a footprint.
inline void for_each_shown_triangle(const Model& model, CellMesh cell, int level,
                                    const std::function<void(Vec3f, Vec3f, Vec3f)>& visit) {
  const Expansion e = expand(model, std::move(cell), level);
  for (std::size_t i = 0; e.inner && i < e.inner->child_count(); ++i)
    for_each_shown_triangle(model, child_cell(model, *e.inner, i), e.inner->level, visit);
  if (!e.leaf) return;
  const Tessellation& t = *e.leaf;
  for (const auto& g : t.grids)
    for (std::uint32_t j = 0; j + 1 < g.height; ++j)
      for (std::uint32_t i = 0; i + 1 < g.width; ++i) {
        const std::uint32_t a = g.first_vertex + j * g.width + i, b = a + 1, c = a + g.width, d = c + 1;
        visit(t.positions[a], t.positions[b], t.positions[c]);
        visit(t.positions[d], t.positions[c], t.positions[b]);
      }
  for (const auto& k : t.triangles) visit(t.positions[k[0]], t.positions[k[1]], t.positions[k[2]]);
}

// Every edge, from vertex to vertex bit for bit, is passed as often in one direction as in the other.
struct ShownTriangles {
  std::map<std::pair<std::array<float, 3>, std::array<float, 3>>, int> balance;
  std::set<std::array<float, 3>> vertices;
  std::size_t triangles = 0;
  double smallest = INFINITY, largest = 0;

  explicit ShownTriangles(const Model& model, const Footprint* footprint) {
    for_each_shown_triangle(model, root_cell(model, footprint), 0, [this](Vec3f a, Vec3f b, Vec3f c) {
      pass(a, b);
      pass(b, c);
      pass(c, a);
      const double area = double(length(cross(b - a, c - a)));
      if (area == 0) return;
      ++triangles;
      for (Vec3f p : {a, b, c}) vertices.insert({p.x, p.y, p.z});
      smallest = std::min(smallest, area);
      largest = std::max(largest, area);
    });
  }
  // Whether every vertex lies near one of the other's, by each coordinate, and there are as many edges.
  bool is_near(const ShownTriangles& other, float distance) const {
    if (balance.size() != other.balance.size() || vertices.size() != other.vertices.size()) return false;
    return std::ranges::all_of(vertices, [&](const std::array<float, 3>& p) {
      for (auto q = other.vertices.lower_bound({p[0] - distance, -INFINITY, -INFINITY});
           q != other.vertices.end() && (*q)[0] <= p[0] + distance; ++q)
        if (std::abs((*q)[1] - p[1]) <= distance && std::abs((*q)[2] - p[2]) <= distance) return true;
      return false;
    });
  }
  bool is_closed() const {
    for (const auto& [edge, count] : balance)
      if (count != 0) return false;
    return true;
  }

 private:
  void pass(Vec3f a, Vec3f b) {
    const std::array<float, 3> p{a.x, a.y, a.z}, q{b.x, b.y, b.z};
    if (p < q) ++balance[{p, q}];
    if (q < p) --balance[{q, p}];
  }
};

// Whether two surfaces have the same vertices, and triangles of the same sizes.
inline bool are_alike(const ShownTriangles& a, const ShownTriangles& b) {
  return a.vertices == b.vertices && a.smallest == b.smallest && a.largest == b.largest;
}

}  // namespace meristem
