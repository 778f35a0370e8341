// Cutting an expanded mesh into child cells.
#pragma once

#include "geometry/cells/expansion.h"

namespace meristem {

// A cell of the listed faces with `rings` rings of halo. Faces and vertices are numbered by walking around the owned
// faces' corners, so that cells of one shape get one numbering (and share their RefinePlans). Cost: linear in the cell.
// `packed`: arrays that were taken out of the mesh.
CellMesh gather_cell(const Mesh& mesh, const VertexFaces& faces_around, std::span<const std::uint32_t> owned, int rings,
                     const PackedArrays* packed = nullptr);

// How many final faces may come of one child of a cell: those of a leaf; of ground on which parts are placed, and of
// which more than a thousand leaves come, so many that it has about as many children as these have leaves.
double faces_of_child(const Model& model, const CellMesh& cell, int level);

// Fills in the children of an inner cell whose mesh, level and faces_around are set: runs of neighbouring faces that
// make one leaf together, single faces that make more; a face that still grows stands with the faces that touch it,
// whose smoothing it reaches, and with others of its kind as far as they make one leaf together.
void make_children(const Model& model, InnerCell& inner);

}  // namespace meristem
