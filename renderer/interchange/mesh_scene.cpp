#include "renderer/interchange/mesh_scene.h"

#include "geometry/io/mesh_file.h"
#include "renderer/interchange/foreign_mesh.h"
#include "renderer/interchange/vertex_colors.h"
#include "renderer/language/json_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>

namespace meristem {

namespace {

// Faces whose corners come to lie together are left out.
void weld_positions(PolygonMesh& mesh, MeshRepairs& repairs) {
  std::map<std::array<double, 3>, std::uint32_t> known;
  std::vector<std::uint32_t> number;
  PolygonMesh out;
  out.uv = std::move(mesh.uv);
  out.names = std::move(mesh.names);
  for (const Vec3d& p : mesh.positions) {
    const auto [entry, is_new] =
        known.try_emplace({p.x + 0.0, p.y + 0.0, p.z + 0.0}, std::uint32_t(out.positions.size()));
    if (is_new) out.positions.push_back(p);
    number.push_back(entry->second);
  }
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const std::size_t first = out.corner_positions.size();
    for (std::uint32_t c = mesh.face_starts[f]; c < mesh.face_starts[f + 1]; ++c) {
      out.corner_positions.push_back(number[mesh.corner_positions[c]]);
      out.corner_uv.push_back(mesh.corner_uv[c]);
    }
    if (!out.face_defect(first).empty()) {
      ++repairs.degenerate;
      out.corner_positions.resize(first);
      out.corner_uv.resize(first);
      continue;
    }
    out.face_starts.push_back(std::uint32_t(out.corner_positions.size()));
    out.face_names.push_back(mesh.face_names[f]);
  }
  mesh = std::move(out);
}

// u, v say the colours from now on; returns the plane on which they lie.
ColorPlane take_colors(PolygonMesh& mesh) {
  ColorPlane plane = nearest_plane(mesh.colors);
  mesh.uv = plane.uv;
  mesh.corner_uv = mesh.corner_positions;
  mesh.names = {""};
  std::ranges::fill(mesh.face_names, 0u);
  return plane;
}

}  // namespace

ForeignScene read_mesh_scene(const std::string& path, Diagnostics& diagnostics) {
  PolygonMesh mesh = load_mesh(path, {}, diagnostics);
  diagnostics.throw_if_errors();
  const Location where{mesh.text, 0};
  const bool is_ply = mesh.face_places.empty();
  const bool has_uv = std::ranges::any_of(mesh.corner_uv, [](std::uint32_t uv) { return uv != PolygonMesh::none; });
  const bool takes_colors = !mesh.colors.empty() && !has_uv;
  if (!mesh.colors.empty() && has_uv)
    diagnostics.warning(where, "colours of vertices were left out, since the mesh has texture coordinates");
  ColorPlane plane;
  if (takes_colors) plane = take_colors(mesh);
  MeshRepairs repairs;
  if (is_ply) weld_positions(mesh, repairs);
  repairs.cut = cut_to_manifold(mesh);
  repairs.report(where, diagnostics);
  if (mesh.face_count() == 0) diagnostics.error(where, "no face has an area");
  diagnostics.throw_if_errors();

  ForeignScene scene;
  ForeignModel model;
  model.name = model.material = std::filesystem::path(path).stem().string();
  std::string color = "[0.5, 0.5, 0.5]";
  if (takes_colors) {
    ColorsByUv colors = color_by_uv(mesh, plane, where, diagnostics);
    model.symbols = std::move(colors.symbols);
    color = std::move(colors.expression);
  }
  scene.materials.push_back(
      {model.material, {}, json::object({{"type", json::text("openpbr")}, {"base_color", json::text(color)}})});
  scene.objects.push_back({model.name, {}});
  model.mesh = std::move(mesh);
  scene.models.push_back(std::move(model));
  return scene;
}

}  // namespace meristem
