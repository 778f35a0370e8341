#include "geometry/cells/step.h"

#include "geometry/base/scratch.h"
#include "geometry/cells/extract.h"
#include "geometry/cells/numbering.h"
#include "geometry/mesh/rings.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace meristem {

namespace {

// Faces `kept`, the owned ones first; rings of both.
CellMesh cut_out(const CellMesh& cell, std::span<const std::uint32_t> owned, std::span<const std::uint32_t> kept,
                 std::vector<std::uint8_t> rings) {
  CellMesh part;
  part.mesh = extract_faces(cell.mesh, kept);
  part.rings = std::move(rings);
  part.owned_faces = std::uint32_t(owned.size());
  if (!cell.labels.empty())
    for (std::uint32_t f : owned) part.labels.push_back(cell.labels[f]);
  part.footprint = cell.footprint;
  return part;
}

}  // namespace

CellMesh cell_of_faces(const CellMesh& cell, std::span<const std::uint32_t> owned, int max_ring) {
  std::vector<std::uint8_t> rings(cell.mesh.face_count(), unreached_ring);
  for (std::uint32_t f : owned) rings[f] = 0;
  find_rings(cell.mesh, rings, max_ring);
  std::vector<std::uint32_t> kept;
  std::vector<std::uint8_t> kept_rings;
  for (int ring = 0; ring <= max_ring; ++ring)
    for (std::uint32_t f = 0; f < cell.mesh.face_count(); ++f)
      if (rings[f] == ring) {
        kept.push_back(f);
        kept_rings.push_back(std::uint8_t(ring));
      }
  return cut_out(cell, owned, kept, std::move(kept_rings));
}

CellMesh cell_of_faces(const CellMesh& cell, std::span<const std::uint32_t> owned, int max_ring,
                       const VertexFaces& faces_around) {
  Numbering reached;
  for (std::uint32_t f : owned) reached.add(f);
  std::vector<std::uint32_t> kept(owned.begin(), owned.end());
  std::vector<std::uint8_t> rings(owned.size(), 0);
  Scratch<std::uint8_t> is_done(cell.mesh.vertex_count(), 0);  // all faces around the vertex are kept
  std::size_t begin = 0;
  for (int ring = 1; ring <= max_ring; ++ring) {
    const std::size_t end = kept.size();
    for (std::size_t i = begin; i < end; ++i)
      for (std::uint32_t v : cell.mesh.corners(kept[i])) {
        if (std::exchange(is_done[v], std::uint8_t(1))) continue;
        for (std::uint32_t f : faces_around.of(v))
          if (reached.add(f).is_new) kept.push_back(f);
      }
    std::sort(kept.begin() + std::ptrdiff_t(end), kept.end());
    rings.resize(kept.size(), std::uint8_t(ring));
    begin = end;
  }
  return cut_out(cell, owned, kept, std::move(rings));
}

namespace {

bool uses_all_vertices(const Mesh& mesh) {
  Scratch<std::uint8_t> is_used(mesh.vertex_count(), 0);
  for (std::uint32_t v : mesh.corner_vertices) is_used[v] = 1;
  return std::ranges::find(is_used.span(), 0) == is_used.span().end();
}

}  // namespace

void trim_halo(CellMesh& cell, int max_ring) {
  if (cell.owned_faces == cell.mesh.face_count() && uses_all_vertices(cell.mesh))
    return cell.rings.assign(cell.owned_faces, 0);
  std::vector<std::uint32_t> owned(cell.owned_faces);
  std::iota(owned.begin(), owned.end(), 0u);
  cell = cell_of_faces(cell, owned, max_ring);
}

}  // namespace meristem
