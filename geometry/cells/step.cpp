#include "geometry/cells/step.h"

#include "geometry/cells/extract.h"
#include "geometry/mesh/rings.h"

#include <numeric>

namespace meristem {

CellMesh cell_of_faces(const CellMesh& cell, std::span<const std::uint32_t> owned, int max_ring) {
  std::vector<std::uint8_t> rings(cell.mesh.face_count(), unreached_ring);
  for (std::uint32_t f : owned) rings[f] = 0;
  find_rings(cell.mesh, rings, max_ring);
  CellMesh part;
  std::vector<std::uint32_t> kept;
  for (int ring = 0; ring <= max_ring; ++ring)
    for (std::uint32_t f = 0; f < cell.mesh.face_count(); ++f)
      if (rings[f] == ring) {
        kept.push_back(f);
        part.rings.push_back(std::uint8_t(ring));
      }
  part.mesh = extract_faces(cell.mesh, kept);
  part.owned_faces = std::uint32_t(owned.size());
  if (!cell.labels.empty())
    for (std::uint32_t f : owned) part.labels.push_back(cell.labels[f]);
  part.footprint = cell.footprint;
  return part;
}

void trim_halo(CellMesh& cell, int max_ring) {
  std::vector<std::uint32_t> owned(cell.owned_faces);
  std::iota(owned.begin(), owned.end(), 0u);
  cell = cell_of_faces(cell, owned, max_ring);
}

}  // namespace meristem
