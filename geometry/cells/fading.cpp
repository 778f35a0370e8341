#include "geometry/cells/fading.h"

#include "geometry/cells/level_of_detail.h"
#include "geometry/cells/tessellation.h"
#include "geometry/mesh/refine.h"

#include <algorithm>

namespace meristem {

namespace {

// Of the next level, for a vertex of an owned face.
float share_of_vertex(const Model& model, const CellMesh& cell, std::uint32_t v, int level) {
  const Mesh& mesh = cell.mesh;
  if (!mesh.frozen.empty() && mesh.frozen[v].is_frozen) return 0;
  return float(share_of_level(model, mesh.nominal_scale[v], cell.footprint->at(mesh.positions[v]), level));
}

}  // namespace

void begin_fading(const Model& model, CellMesh& cell, int level) {
  if (!fades(cell) || model.drops_faces_later(level)) return;
  Mesh& mesh = cell.mesh;
  std::vector<FadingVertex> fading(mesh.vertex_count());
  bool any = false;
  for (std::uint32_t c = 0; c < mesh.face_starts[cell.owned_faces]; ++c) {
    const std::uint32_t v = mesh.corner_vertices[c];
    const float share = share_of_vertex(model, cell, v, level);
    fading[v].share = share;
    any = any || share < 1;
  }
  if (any) {
    const LimitSurface surface = shown_surface(cell, model.smoothing(level));
    const std::vector<Vec2d> uv = vertex_uv(mesh);
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
      FadingVertex shown = !mesh.frozen.empty() && mesh.frozen[v].is_frozen
                               ? FadingVertex{0, mesh.frozen[v].position, mesh.frozen[v].normal, mesh.frozen[v].uv}
                               : faded(mesh, v, Vec3f(surface.positions[v]), Vec3f(surface.normals[v]),
                                       Vec2f{float(uv[v].x), float(uv[v].y)});
      shown.share = fading[v].share;
      fading[v] = shown;
    }
  }
  mesh.fading = std::move(fading);
}

}  // namespace meristem
