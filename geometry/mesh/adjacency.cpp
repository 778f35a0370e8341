#include "geometry/mesh/adjacency.h"

#include <fmt/format.h>

#include <algorithm>

namespace meristem {

namespace {

// Turns counts in starts[1..] into offsets, and fills `list` by calling visit(put) with put(row, value).
template <class Visit>
void fill_rows(std::uint32_t rows, std::vector<std::uint32_t>& starts, std::vector<std::uint32_t>& list, Visit visit) {
  starts.assign(rows + 1, 0);
  visit([&](std::uint32_t row, std::uint32_t) { ++starts[row + 1]; });
  for (std::uint32_t i = 0; i < rows; ++i) starts[i + 1] += starts[i];
  list.resize(starts[rows]);
  std::vector<std::uint32_t> next(starts.begin(), starts.end() - 1);
  visit([&](std::uint32_t row, std::uint32_t value) { list[next[row]++] = value; });
}

}  // namespace

Adjacency::Adjacency(const Mesh& mesh) {
  find_edges(mesh);
  fill_rows(mesh.vertex_count(), face_starts_, faces_, [&](auto put) {
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
      for (std::uint32_t v : mesh.corners(f)) put(v, f);
  });
  fill_rows(mesh.vertex_count(), edge_starts_, edge_list_, [&](auto put) {
    for (std::uint32_t e = 0; e < edge_count(); ++e)
      for (std::uint32_t v : edges_[e].vertices) put(v, e);
  });
}

std::size_t Adjacency::bytes() const {
  return sizeof(*this) + edges_.capacity() * sizeof(Edge) +
         4 * (corner_edges_.capacity() + face_starts_.capacity() + faces_.capacity() + edge_starts_.capacity() +
              edge_list_.capacity());
}

void Adjacency::find_edges(const Mesh& mesh) {
  first_edge_.assign(mesh.vertex_count(), none);
  corner_edges_.resize(mesh.corner_vertices.size());
  edges_.reserve(mesh.corner_vertices.size() / 2 + 16);
  next_edge_.reserve(mesh.corner_vertices.size());
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = mesh.corners(f);
    for (std::size_t i = 0; i < corners.size(); ++i)
      add_edge_side(mesh, f, mesh.face_starts[f] + std::uint32_t(i), corners[i], corners[(i + 1) % corners.size()]);
  }
  first_edge_ = {};
  next_edge_ = {};
}

void Adjacency::add_edge_side(const Mesh& mesh, std::uint32_t face, std::uint32_t corner, std::uint32_t from,
                              std::uint32_t to) {
  const std::uint32_t low = std::min(from, to);
  for (std::uint32_t e = first_edge_[low]; e != none; e = next_edge_[e]) {
    Edge& edge = edges_[e];
    if (edge.vertices[0] + edge.vertices[1] != from + to || std::min(edge.vertices[0], edge.vertices[1]) != low)
      continue;
    if (edge.faces[1] != none)
      defect_ = fmt::format("the edge between vertices {} and {} has more than two faces", from, to);
    else if (edge.vertices[0] == from)
      defect_ = fmt::format("faces {} and {} run the same way along the edge from vertex {} to {}", edge.faces[0], face,
                            from, to);
    else
      edge.faces[1] = face;
    corner_edges_[corner] = e;
    return;
  }
  corner_edges_[corner] = edge_count();
  next_edge_.push_back(first_edge_[low]);
  first_edge_[low] = edge_count();
  edges_.push_back({{from, to}, {face, none}, mesh.corner_sharpness.empty() ? 0 : mesh.corner_sharpness[corner]});
}

}  // namespace meristem
