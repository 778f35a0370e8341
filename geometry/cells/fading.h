// Fading: the last level of a vertex comes in by and by, so that what is shown is a continuous function of the
// footprint and nothing jumps when a camera moves.
//
// While a vertex is up to twice as large as wanted, the level that it still gets is shown by a share: of its own place
// by as much as its size exceeds the wanted one (0 at the wanted size, where the level would begin; 1 at twice that,
// where the next one does), of the surface without that level by the rest: where the vertex itself was shown, the
// middle of an edge, the diagonal of a face. An edge and a face take the largest share of their ends. All of that
// follows from the vertex and its parents alone, so cells agree, and edges that are shared stay shared.
//
// Where the footprint is larger on one side of a face by more than two levels, what is in between may still jump.
#pragma once

#include "geometry/cells/model.h"

namespace meristem {

// Whether levels fade in for that cell.
inline bool fades(const CellMesh& cell) { return cell.footprint && cell.footprint->fades(); }

// A vertex as it is shown of a surface on which it lies there.
inline FadingVertex faded(const Mesh& mesh, std::uint32_t v, Vec3f position, Vec3f normal, Vec2f uv) {
  if (mesh.fading.empty() || mesh.fading[v].share >= 1) return {1, position, normal, uv};
  const FadingVertex& from = mesh.fading[v];
  const float share = from.share;
  return {share, lerp(from.position, position, share), normalize(lerp(from.normal, normal, share)),
          from.uv * (1 - share) + uv * share};
}

// Extends a box by where an earlier level keeps a vertex, or draws it to, so far as it does.
inline void extend_by_earlier_levels(const Mesh& mesh, std::uint32_t v, Bounds3d& box) {
  if (!mesh.frozen.empty() && mesh.frozen[v].is_frozen) box.extend(Vec3d(mesh.frozen[v].position));
  if (!mesh.fading.empty() && mesh.fading[v].share < 1) box.extend(Vec3d(mesh.fading[v].position));
}

// Of a cell just before the refinement that is step `level`, once its vertices are frozen: replaces what its vertices
// fade in from by what they are shown as now, with the shares of the level to come. Costs a surface where there are
// such vertices.
void begin_fading(const Model& model, CellMesh& cell, int level);

}  // namespace meristem
