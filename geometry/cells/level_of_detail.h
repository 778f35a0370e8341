// Level of detail: which vertices of a cell are as fine as wanted ("only to that extent that the geometry can be
// approximated well enough", the paper's section 6).
//
// Decided by vertex, from the vertex alone, so that all cells that hold it decide alike without talking to each other:
// a vertex *freezes* at the first level where its nominal scale (the local scale that smooth refinement alone leaves:
// it varies gently where the displaced surface is rough), the displacements still to come and the growth still to come
// on its faces are all within the footprint there. A frozen vertex is shown where it was frozen, whatever finer levels
// make of it; an edge between two frozen vertices is not split (the vertex that refinement puts there is shown at one
// of them), so neighbours of different levels meet without cracks or T-vertices. A cell whose vertices are all frozen
// is final. M(n) itself, the mesh of level n, never depends on what is frozen.
#pragma once

#include "geometry/cells/model.h"

#include <functional>

namespace meristem {

// Freezes what is fine enough in a cell before step `level`; returns whether every vertex of its owned faces is frozen
// now or would be: then the cell is final as it is (and nothing new has been marked). False without a footprint.
// `wanted`, if given, becomes by vertex how many refinements it still wants, were it not to move (of vertices of the
// halo alone, and without a footprint: all that are left).
bool freeze_vertices(const Model& model, CellMesh& cell, int level, std::vector<std::uint8_t>* wanted = nullptr);

// The same where only bounds are asked for and levels do not fade: the surface, which is dear, is not evaluated. What
// freezes is kept at its control point and calls visit(vertex, box): where it is shown lies in that box of the corners
// of its faces, but for rounding.
using FrozenBox = std::function<void(std::uint32_t vertex, const Bounds3d& box)>;
bool freeze_in_boxes(const Model& model, CellMesh& cell, int level, std::vector<std::uint8_t>* wanted,
                     const FrozenBox& visit);

// The share of step `level` in what is shown of a vertex of that nominal scale that is not frozen, where levels fade
// in: by how much the larger of its size and of what may still be added to it exceeds the wanted one. All of it, if it
// is fine enough: then it bears what is still to grow.
double share_of_level(const Model& model, double scale, double footprint, int level);

// Takes the symbols of faces on which everything that will ever grow is smaller than the footprint, and, where symbols
// thin, of some of those on which all is small; on the others it will be larger (thinning.h). They carry none
// then, as far as a sign tells, but remember which it was: for rules that ask what stands beside them.
void leave_out_small_growth(const Model& model, CellMesh& cell, int level);
constexpr std::int16_t omitted_symbol(std::int16_t symbol) { return std::int16_t(-2 - symbol); }
constexpr std::int16_t symbol_before_omission(std::int16_t symbol) {
  return symbol < -1 ? std::int16_t(-2 - symbol) : symbol;
}

// About how many final faces come of a face of a cell before step `level`. For cutting cells only.
double wanted_faces(const Model& model, const CellMesh& cell, std::uint32_t face, int level);

// Measures the nominal scale of vertices that have none yet: the mean over their faces of the mean diagonal. All are
// measured anew two refinements after growth or the base mesh: most of what smoothing takes off a coarse cage is gone
// then. For cells with a footprint; done by freeze_vertices() too.
void measure_nominal_scale(const Model& model, CellMesh& cell, int level);

}  // namespace meristem
