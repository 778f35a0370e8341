#include "geometry/mesh/rings.h"

#include <algorithm>
#include <numeric>

namespace meristem {

std::vector<std::uint8_t> face_rings(const Mesh& mesh, std::uint32_t owned_faces, int max_ring) {
  std::vector<std::uint8_t> rings(mesh.face_count(), unreached_ring);
  std::fill_n(rings.begin(), owned_faces, std::uint8_t(0));
  if (owned_faces < mesh.face_count()) find_rings(mesh, rings, max_ring);
  return rings;
}

void find_rings(const Mesh& mesh, std::vector<std::uint8_t>& rings, int max_ring) {
  std::vector<std::uint8_t> touched(mesh.vertex_count(), 0);
  for (int ring = 1; ring <= max_ring; ++ring) {
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
      if (rings[f] == ring - 1)
        for (std::uint32_t v : mesh.corners(f)) touched[v] = 1;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      if (rings[f] != unreached_ring) continue;
      for (std::uint32_t v : mesh.corners(f))
        if (touched[v]) rings[f] = std::uint8_t(ring);
    }
  }
}

VertexFaces::VertexFaces(const Mesh& mesh) : starts_(mesh.vertex_count() + 1, 0), faces_(mesh.corner_vertices.size()) {
  for (std::uint32_t v : mesh.corner_vertices) ++starts_[v];
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());  // now the ends of rows, which fill from there
  for (std::uint32_t f = mesh.face_count(); f-- > 0;)
    for (std::uint32_t v : mesh.corners(f)) faces_[--starts_[v]] = f;
}

}  // namespace meristem
