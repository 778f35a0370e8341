#include "procedural/subdivision/drop_border_step.h"

#include "geometry/cells/gather.h"
#include "geometry/mesh/adjacency.h"

#include <algorithm>

namespace meristem {

// A halo ends like a boundary, but not at an owned face, which has a ring of it.
void DropBorderStep::apply(const CellMesh& in, int rings_after, CellMesh& out) const {
  const Adjacency adjacency(in.mesh);
  std::vector<bool> is_at_border(in.mesh.vertex_count(), false);
  for (std::uint32_t e = 0; e < adjacency.edge_count(); ++e)
    if (adjacency.edge(e).faces[1] == Adjacency::none)
      for (std::uint32_t v : adjacency.edge(e).vertices) is_at_border[v] = true;
  std::vector<std::uint32_t> kept, labels;
  for (std::uint32_t f = 0; f < in.owned_faces; ++f) {
    if (std::ranges::any_of(in.mesh.corners(f), [&](std::uint32_t v) { return is_at_border[v]; })) continue;
    kept.push_back(f);
    if (!in.labels.empty()) labels.push_back(in.labels[f]);
  }
  out = gather_cell(in.mesh, VertexFaces(in.mesh), kept, rings_after);
  out.labels = std::move(labels);
}

}  // namespace meristem
