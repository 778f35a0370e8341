#include "renderer/interchange/foreign_mesh.h"

#include "geometry/base/key.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <unordered_map>

namespace meristem {

namespace {

// A vertex as what it is welded by.
struct Identity {
  Vec3d position;
  Vec3f normal;
  bool operator==(const Identity&) const = default;
};
struct IdentityHash {
  std::size_t operator()(const Identity& i) const {
    Key key = 0;
    for (int k = 0; k < 3; ++k) {
      key = hash_keys(key, std::bit_cast<std::uint64_t>(i.position[k] + 0.0));  // -0 is 0
      key = hash_keys(key, std::bit_cast<std::uint32_t>(i.normal[k] + 0.f));
    }
    return key;
  }
};

// The corners of one face after welding: those without a repeated vertex behind each other.
class Welding {
 public:
  explicit Welding(const ForeignMesh& mesh) : mesh_(mesh) {}

  std::uint32_t vertex(std::uint32_t old, PolygonMesh& out) {
    if (mesh_.normals.empty()) return add(old, out);
    const auto [known, is_new] =
        numbers_.try_emplace({mesh_.positions[old], mesh_.normals[old]}, std::uint32_t(out.positions.size()));
    if (is_new) add(old, out);
    return known->second;
  }

 private:
  std::uint32_t add(std::uint32_t old, PolygonMesh& out) const {
    out.positions.push_back(mesh_.positions[old]);
    return std::uint32_t(out.positions.size()) - 1;
  }

  const ForeignMesh& mesh_;
  std::unordered_map<Identity, std::uint32_t, IdentityHash> numbers_;
};

bool has_area(const ForeignMesh& mesh, std::size_t first, std::size_t last) {
  Vec3d normal{};
  for (std::size_t c = first; c < last; ++c) {
    const Vec3d a = mesh.positions[mesh.corners[c]], b = mesh.positions[mesh.corners[c + 1 < last ? c + 1 : first]];
    normal += cross(a - mesh.positions[mesh.corners[first]], b - mesh.positions[mesh.corners[first]]);
  }
  return length_squared(normal) > 0;
}

// Sets of corners that are one vertex.
class Union {
 public:
  explicit Union(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

struct HalfEdge {
  std::uint32_t low, high;  // vertices
  std::uint32_t corner_low, corner_high;
  bool forward;  // from low to high
};

std::vector<HalfEdge> half_edges(const PolygonMesh& mesh) {
  std::vector<HalfEdge> edges;
  edges.reserve(mesh.corner_positions.size());
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    for (std::uint32_t c = mesh.face_starts[f]; c < mesh.face_starts[f + 1]; ++c) {
      const std::uint32_t next = c + 1 < mesh.face_starts[f + 1] ? c + 1 : mesh.face_starts[f];
      const std::uint32_t a = mesh.corner_positions[c], b = mesh.corner_positions[next];
      edges.push_back(a < b ? HalfEdge{a, b, c, next, true} : HalfEdge{b, a, next, c, false});
    }
  std::ranges::stable_sort(
      edges, [](const HalfEdge& a, const HalfEdge& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; });
  return edges;
}

// Calls visit(first, last) for the half-edges of each edge.
template <class Visit>
void for_each_edge(const std::vector<HalfEdge>& edges, const Visit& visit) {
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
    visit(i, end);
    i = end;
  }
}

// The faces that pass an edge that others pass in the same direction.
std::vector<bool> faces_in_conflict(const PolygonMesh& mesh) {
  const std::vector<HalfEdge> edges = half_edges(mesh);
  std::vector<bool> corners(mesh.corner_positions.size(), false), faces(mesh.face_count(), false);
  for_each_edge(edges, [&](std::size_t first, std::size_t last) {
    const auto forward = std::count_if(edges.begin() + std::ptrdiff_t(first), edges.begin() + std::ptrdiff_t(last),
                                       [](const HalfEdge& e) { return e.forward; });
    if (forward <= 1 && std::ptrdiff_t(last - first) - forward <= 1) return;
    for (std::size_t i = first; i < last; ++i) corners[edges[i].corner_low] = true;
  });
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    for (std::uint32_t c = mesh.face_starts[f]; c < mesh.face_starts[f + 1]; ++c)
      if (corners[c]) faces[f] = true;
  return faces;
}

// Gives all of them vertices of their own, until there are none.
void separate_conflicts(PolygonMesh& mesh) {
  for (;;) {
    const std::vector<bool> faces = faces_in_conflict(mesh);
    if (std::ranges::find(faces, true) == faces.end()) return;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
      for (std::uint32_t c = mesh.face_starts[f]; faces[f] && c < mesh.face_starts[f + 1]; ++c) {
        mesh.positions.push_back(Vec3d(mesh.positions[mesh.corner_positions[c]]));
        mesh.corner_positions[c] = std::uint32_t(mesh.positions.size()) - 1;
      }
  }
}

}  // namespace

void ForeignMesh::add_face(std::initializer_list<std::uint32_t> vertices) {
  corners.insert(corners.end(), vertices);
  face_starts.push_back(std::uint32_t(corners.size()));
}

void MeshRepairs::report(const Location& where, Diagnostics& diagnostics) const {
  if (degenerate > 0) diagnostics.warning(where, fmt::format("{} faces without area were left out", degenerate));
  if (cut > 0)
    diagnostics.warning(
        where,
        fmt::format("faces that meet in points alone, or more than two in an edge, were cut apart: {} more vertices",
                    cut));
}

PolygonMesh to_polygon_mesh(const ForeignMesh& mesh, MeshRepairs& repairs) {
  PolygonMesh out;
  out.names = {""};
  for (const Vec2d uv : mesh.uv) out.uv.push_back(uv);
  Welding welding(mesh);
  for (std::size_t f = 0; f + 1 < mesh.face_starts.size(); ++f) {
    const std::size_t begin = mesh.face_starts[f], end = mesh.face_starts[f + 1];
    if (end - begin < 3 || !has_area(mesh, begin, end)) {
      ++repairs.degenerate;
      continue;
    }
    const std::size_t first = out.corner_positions.size(), vertices = out.positions.size();
    for (std::size_t c = begin; c < end; ++c) {
      out.corner_positions.push_back(welding.vertex(mesh.corners[c], out));
      out.corner_uv.push_back(mesh.uv.empty() ? PolygonMesh::none : mesh.corners[c]);
    }
    if (!out.face_defect(first).empty()) {
      ++repairs.degenerate;
      out.corner_positions.resize(first);
      out.corner_uv.resize(first);
      if (mesh.normals.empty()) out.positions.resize(vertices);
      continue;
    }
    out.face_starts.push_back(std::uint32_t(out.corner_positions.size()));
    out.face_names.push_back(0);
  }
  repairs.cut += cut_to_manifold(out);
  return out;
}

// Corners of a vertex are one only if a chain of edges that exactly two faces pass, in opposite directions, joins them.
std::size_t cut_to_manifold(PolygonMesh& mesh) {
  const std::vector<HalfEdge> edges = half_edges(mesh);
  Union corners(mesh.corner_positions.size());
  for_each_edge(edges, [&](std::size_t i, std::size_t end) {
    if (end - i != 2 || edges[i].forward == edges[i + 1].forward) return;
    corners.join(edges[i].corner_low, edges[i + 1].corner_low);
    corners.join(edges[i].corner_high, edges[i + 1].corner_high);
  });
  constexpr std::uint32_t none = PolygonMesh::none;
  std::vector<std::uint32_t> vertex_of(mesh.corner_positions.size(), none);  // by the corner that stands for the set
  std::vector<bool> taken(mesh.positions.size(), false);
  const std::size_t before = mesh.positions.size();
  for (std::uint32_t c = 0; c < mesh.corner_positions.size(); ++c) {
    const std::uint32_t old = mesh.corner_positions[c];
    std::uint32_t& vertex = vertex_of[corners.find(c)];
    if (vertex == none) {
      vertex = old;
      if (taken[old]) {
        vertex = std::uint32_t(mesh.positions.size());
        mesh.positions.push_back(Vec3d(mesh.positions[old]));
      }
      taken[old] = true;
    }
    mesh.corner_positions[c] = vertex;
  }
  separate_conflicts(mesh);
  return mesh.positions.size() - before;
}

}  // namespace meristem
