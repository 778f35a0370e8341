// What will come of the parts of a cell, found by looking some levels ahead.
//
// What displacement over several levels can do at the worst is far more than what it does: neighbours could part by
// twice the amplitude, which makes the next level's local scale larger, and so on; boxes from such bounds alone were 8
// to 40 times too large on ridged bark. And a stem that may turn at every step could go anywhere. So before an expanded
// mesh is split, all of it is grown to the end and carried a few refinements further (without halos between its cells,
// a small part of the work of expanding them), and only the levels after these are bounded by analysis (Extent,
// Step::bound).
#pragma once

#include "geometry/cells/expansion.h"

namespace meristem {

struct Outlook {
  Bounds3d bounds;   // conservative, of everything that comes of it
  double faces = 0;  // about how many final faces
};

// The outlook of each group of owned faces of `cell`, a mesh before step `level`. `group_of` names the group of every
// owned face. None: what still grows is too much to be grown for this.
std::optional<std::vector<Outlook>> look_ahead(const Model& model, const CellMesh& cell, int level,
                                               std::span<const std::uint32_t> group_of, std::size_t group_count);

}  // namespace meristem
