#include "geometry/cells/step.h"

#include "geometry/cells/extract.h"
#include "geometry/mesh/rings.h"

namespace meristem {

void trim_halo(CellMesh& cell, int max_ring) {
  const std::vector<std::uint8_t> rings = face_rings(cell.mesh, cell.owned_faces, max_ring);
  std::vector<std::uint32_t> kept;
  std::vector<std::uint8_t> kept_rings;
  for (int ring = 0; ring <= max_ring; ++ring)
    for (std::uint32_t f = 0; f < cell.mesh.face_count(); ++f)
      if (rings[f] == ring) {
        kept.push_back(f);
        kept_rings.push_back(std::uint8_t(ring));
      }
  cell.mesh = extract_faces(cell.mesh, kept);
  cell.rings = std::move(kept_rings);
}

}  // namespace meristem
