// Faces that are as fine as wanted before the rest of their cell is: taken out of it, so that no further level is spent
// on them.
#pragma once

#include "geometry/cells/tessellation.h"

#include <optional>

namespace meristem {

// Takes those owned squares of a cell before step `level` all of whose vertices are frozen, if they are so many that
// the rest is worth a mesh of its own. They stay as halo as far as the rest needs them, so it comes out with the same
// bits. The cell is not final. Linear in the cell.
std::optional<DoneFaces> take_done_faces(const Model& model, CellMesh& cell, int level, Squares& squares);

}  // namespace meristem
