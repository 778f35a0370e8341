// Adjacency: the edges of a mesh and who meets whom, built in one pass over the corners (about 60 ns a corner).
// Order is that of first appearance, so it depends on the mesh's own order alone. Immutable; any thread may read.
#pragma once

#include "geometry/mesh/mesh.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace meristem {

class Adjacency {
 public:
  static constexpr std::uint32_t none = ~std::uint32_t(0);

  struct Edge {
    std::uint32_t vertices[2];  // in the direction of the first face
    std::uint32_t faces[2];     // the second is `none` on a boundary
    float sharpness = 0;
  };

  explicit Adjacency(const Mesh& mesh);

  std::uint32_t edge_count() const { return std::uint32_t(edges_.size()); }
  const Edge& edge(std::uint32_t e) const { return edges_[e]; }
  // The edge from corner c to the next corner of its face.
  std::uint32_t edge_of_corner(std::uint32_t c) const { return corner_edges_[c]; }
  std::span<const std::uint32_t> faces_of_vertex(std::uint32_t v) const { return row(face_starts_, faces_, v); }
  std::span<const std::uint32_t> edges_of_vertex(std::uint32_t v) const { return row(edge_starts_, edge_list_, v); }
  // What breaks the manifold at an edge (three faces, or two in the same direction), or an empty text.
  const std::string& defect() const { return defect_; }
  std::size_t bytes() const;

 private:
  static std::span<const std::uint32_t> row(const std::vector<std::uint32_t>& starts,
                                            const std::vector<std::uint32_t>& list, std::uint32_t i) {
    return {list.data() + starts[i], starts[i + 1] - starts[i]};
  }
  void find_edges(const Mesh& mesh);
  void add_edge_side(const Mesh& mesh, std::uint32_t face, std::uint32_t corner, std::uint32_t from, std::uint32_t to);

  std::vector<Edge> edges_;
  std::vector<std::uint32_t> corner_edges_;
  std::vector<std::uint32_t> face_starts_, faces_;      // by vertex
  std::vector<std::uint32_t> edge_starts_, edge_list_;  // by vertex
  std::vector<std::uint32_t> first_edge_, next_edge_;  // while building: edges by their smaller vertex, as linked lists
  std::string defect_;
};

}  // namespace meristem
