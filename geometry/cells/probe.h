// Bounds of child cells by looking some levels ahead.
//
// What displacement over several levels can do at the worst is far more than what it does: neighbours could part by
// twice the amplitude, which makes the next level's local scale larger, and so on; boxes from such bounds alone were 8
// to 40 times too large on ridged bark. So before an expanded mesh is split, all of it is carried a few refinements
// further (without halos between its cells, a small part of the work of expanding them), and only the levels after
// these are bounded by analysis (Extent, Step::bound).
#pragma once

#include "geometry/cells/expansion.h"

namespace meristem {

// Conservative final bounds of everything that comes of each group of owned faces of `cell`, a mesh before step
// `level`. `group_of` names the group of every owned face. Only refinements may follow from `level` on.
std::vector<Bounds3d> probed_bounds(const Model& model, const CellMesh& cell, int level,
                                    std::span<const std::uint32_t> group_of, std::size_t group_count);

}  // namespace meristem
