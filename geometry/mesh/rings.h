// Rings of faces around a set of faces.
#pragma once

#include "geometry/mesh/mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meristem {

constexpr std::uint8_t unreached_ring = 255;

// The distance of every face from the first `owned_faces` by shared vertices (0 for these, 1 for faces that touch one,
// ...); unreached_ring beyond max_ring. Linear in the mesh for each ring.
std::vector<std::uint8_t> face_rings(const Mesh& mesh, std::uint32_t owned_faces, int max_ring);

// The same around any faces: `rings` is 0 at these and unreached_ring elsewhere, and is filled in.
void find_rings(const Mesh& mesh, std::vector<std::uint8_t>& rings, int max_ring);

// The faces at every vertex of a mesh, by number: for looking around few of its faces. Some 15 ns a corner.
class VertexFaces {
 public:
  VertexFaces() = default;  // of no mesh
  explicit VertexFaces(const Mesh& mesh);
  std::span<const std::uint32_t> of(std::uint32_t vertex) const {
    return std::span(faces_).subspan(starts_[vertex], starts_[vertex + 1] - starts_[vertex]);
  }
  std::size_t bytes() const { return sizeof(*this) + sizeof(std::uint32_t) * (starts_.capacity() + faces_.capacity()); }

 private:
  std::vector<std::uint32_t> starts_, faces_;
};

}  // namespace meristem
