// Walks through the inside of a closed model, which no ray may leave, were it aimed exactly at where cells meet. Embree
// itself loses some 0.5 % of the rays that are aimed at a vertex to the last bit (its robust triangle test is exact at
// edges only), with cells or without; so what the cells lose is told by asking the flat model as well.
#pragma once

#include "geometry/accel/world.h"
#include "geometry/base/parallel.h"
#include "geometry/cells/expansion.h"

#include <atomic>
#include <map>
#include <set>
#include <tuple>

namespace meristem {

using Corner = std::tuple<float, float, float>;
using Edge = std::pair<Corner, Corner>;

inline Corner corner(Vec3f p) { return {p.x, p.y, p.z}; }
inline Vec3f position(const Corner& c) { return {std::get<0>(c), std::get<1>(c), std::get<2>(c)}; }

inline std::set<Edge> edges_of(const Tessellation& t) {
  std::set<Edge> edges;
  const auto add = [&](std::uint32_t a, std::uint32_t b) {
    const Corner from = corner(t.positions[a]), to = corner(t.positions[b]);
    if (from != to) edges.insert(std::minmax(from, to));  // grids hold copies of vertices where they are coarser
  };
  for (const auto& g : t.grids)
    for (std::uint32_t j = 0; j < g.height; ++j)
      for (std::uint32_t i = 0; i < g.width; ++i) {
        const std::uint32_t v = g.first_vertex + j * g.width + i;
        if (i + 1 < g.width) add(v, v + 1);
        if (j + 1 < g.height) add(v, v + g.width);
      }
  for (const auto& [a, b, c] : t.triangles) add(a, b), add(b, c), add(c, a);
  return edges;
}

inline void count_edges(const Model& model, CellMesh cell, int level, std::map<Edge, int>& leaves_with) {
  const Expansion e = expand(model, std::move(cell), level);
  if (e.leaf) {
    for (const Edge& edge : edges_of(*e.leaf)) ++leaves_with[edge];
    return;
  }
  for (std::size_t i = 0; i < e.inner->child_count(); ++i)
    count_edges(model, child_cell(model, *e.inner, i), e.inner->level, leaves_with);
}

// The edges along which cells meet, by where they are.
class Borders {
 public:
  Borders(const Model& model, const Footprint* footprint) {
    std::map<Edge, int> leaves_with;
    count_edges(model, root_cell(model, footprint), 0, leaves_with);
    for (const auto& [edge, leaves] : leaves_with)
      if (leaves > 1) {
        by_place_[place(position(edge.first))].push_back(edge);
        ++count_;
      }
  }
  std::size_t count() const { return count_; }

  struct Target {
    Vec3f point;
    bool is_near = false, is_vertex = false;
  };
  // A vertex of a border close to p, or a point on an edge of it; p if none is near.
  Target target(Vec3f p, Key key) const {
    const auto near = by_place_.find(place(p));
    if (near == by_place_.end()) return {p};
    const auto& [a, b] = near->second[key % near->second.size()];
    const Vec3f from = position(a);
    if (key >> 32 & 1) return {from, true, true};
    return {from + (position(b) - from) * uniform_float(hash_keys(key, 1)), true, false};
  }

 private:
  static std::tuple<int, int, int> place(Vec3f p) {
    const auto index = [](float x) { return int(std::floor(x / 0.1f)); };
    return {index(p.x), index(p.y), index(p.z)};
  }

  std::map<std::tuple<int, int, int>, std::vector<Edge>> by_place_;
  std::size_t count_ = 0;
};

inline Vec3f direction(Key key) {
  const double z = 1 - 2 * uniform_double(hash_keys(key, 1)), a = 2 * pi * uniform_double(hash_keys(key, 2)),
               s = std::sqrt(1 - z * z);
  return {float(s * std::cos(a)), float(s * std::sin(a)), float(z)};
}

struct EscapeCounts {
  std::atomic<int> random_escapes{0};
  std::atomic<int> at_edges{0}, edge_escapes{0};
  std::atomic<int> at_vertices{0}, vertex_escapes{0};
  std::atomic<int> between_cells{0};  // of all escapes of aimed rays: those that hit the flat model
};

// Walks from `start`, a point inside, to the next, half-way to what a random ray hits; at each, a second ray is aimed
// at the border of two cells near that hit.
inline void walk_inside(const Intersector& world, const Intersector& flat, const Borders& borders, Vec3f start,
                        Key walk, int rays, EscapeCounts& counts) {
  Vec3f p = start;
  for (int i = 0; i < rays; ++i) {
    const Key key = hash_keys(walk, Key(i));
    SurfaceHit hit;
    if (!world.intersect({p, direction(key)}, hit)) {
      ++counts.random_escapes;
      p = start;
      continue;
    }
    const Borders::Target target = borders.target(hit.position, hash_keys(key, 3));
    const Ray aimed{p, target.point - p};
    const bool escapes = !world.occluded(aimed);
    counts.at_edges += target.is_near && !target.is_vertex;
    counts.at_vertices += target.is_vertex;
    counts.edge_escapes += escapes && !target.is_vertex;
    counts.vertex_escapes += escapes && target.is_vertex;
    counts.between_cells += escapes && flat.occluded(aimed);
    // Thin ends are left again before rounding matters
    p = hit.t > 0.02f ? p + direction(key) * (hit.t * 0.5f) : start;
  }
}

// So many walks of so many rays on two threads, through `lazy` and `flat`, the same model in worlds of either kind.
inline void walk_inside(const Intersector& lazy, const Intersector& flat, const Borders& borders, Vec3f start,
                        int walks, int rays_per_walk, EscapeCounts& counts) {
  std::atomic<int> next{0};
  run_threads(2, [&](int) {
    for (int w; (w = next.fetch_add(1)) < walks;)
      walk_inside(lazy, flat, borders, start, Key(w), rays_per_walk, counts);
  });
}

}  // namespace meristem
