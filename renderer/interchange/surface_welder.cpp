#include "renderer/interchange/surface_welder.h"

#include "geometry/base/key.h"
#include "geometry/cells/uv_packing.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace meristem {

namespace {

constexpr std::uint32_t none = ~std::uint32_t(0);

bool is_degenerate(const std::array<std::uint32_t, 3>& v) { return v[0] == v[1] || v[1] == v[2] || v[2] == v[0]; }

// Which of `count` vertices lie on an edge that triangles pass more often in one direction than in the other.
std::vector<bool> on_border(const std::vector<SurfaceWelder::Triangle>& triangles, std::size_t count) {
  std::vector<std::uint64_t> edges;
  edges.reserve(triangles.size() * 3);
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.push_back(std::uint64_t(t.vertices[k]) << 32 | t.vertices[(k + 1) % 3]);
  std::ranges::sort(edges);
  std::vector<bool> result(count, false);
  for (const std::uint64_t edge : edges) {
    const auto there = std::ranges::equal_range(edges, edge),
               back = std::ranges::equal_range(edges, edge << 32 | edge >> 32);
    if (there.size() != back.size()) result[edge >> 32] = result[edge & none] = true;
  }
  return result;
}

}  // namespace

std::size_t SurfaceWelder::Vertices::Hash::operator()(Vec3f p) const {
  const auto bits = [](float x) { return Key(std::bit_cast<std::uint32_t>(x + 0.f)); };  // -0 is 0
  return hash_keys(bits(p.x) << 32 | bits(p.y), bits(p.z));
}

std::uint32_t SurfaceWelder::Vertices::find_or_add(Vec3f position, PackedNormal normal, Vec2f uv,
                                                   std::uint32_t number) {
  constexpr float agree = 0.5f;     // within 60 degrees
  constexpr float same_uv = 1e-3f;  // what is shared differs by rounding at most
  const auto [first, last] = vertices_.equal_range(position);
  for (auto v = first; v != last; ++v)
    if (dot(v->second.normal.unpack(), normal.unpack()) > agree && std::abs(v->second.uv.x - uv.x) <= same_uv &&
        std::abs(v->second.uv.y - uv.y) <= same_uv)
      return v->second.number;
  vertices_.emplace(position, Vertex{normal, uv, number});
  return number;
}

SurfaceWelder::Piece SurfaceWelder::add(const Tessellation& cell) {
  // Weld within the cell: every vertex is the first at its place
  const std::vector<Vec2f> uv = vertex_uv(cell);
  Vertices local;
  std::vector<std::uint32_t> first(cell.positions.size());
  for (std::uint32_t v = 0; v < first.size(); ++v)
    first[v] = local.find_or_add(cell.positions[v], cell.attributes[v].normal, uv[v], v);
  Piece piece;
  for_each_triangle(cell, [&](const std::array<std::uint32_t, 3>& v, std::uint32_t origin) {
    const Triangle welded{{first[v[0]], first[v[1]], first[v[2]]}, origin};
    if (!is_degenerate(welded.vertices)) piece.triangles.push_back(welded);
  });

  // Number what is used, and weld it to other cells where it lies on the border
  const std::vector<bool> border = on_border(piece.triangles, first.size());
  std::vector<std::uint32_t> numbers(first.size(), none);
  piece.first_vertex = vertices_;
  for (Triangle& t : piece.triangles)
    for (std::uint32_t& v : t.vertices) {
      if (numbers[v] == none) {
        numbers[v] =
            border[v] ? border_.find_or_add(cell.positions[v], cell.attributes[v].normal, uv[v], vertices_) : vertices_;
        if (numbers[v] == vertices_) {
          ++vertices_;
          piece.cell_vertices.push_back(v);
        }
      }
      v = numbers[v];
    }
  return piece;
}

}  // namespace meristem
