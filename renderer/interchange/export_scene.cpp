#include "renderer/interchange/export_scene.h"

#include "geometry/cells/uv_packing.h"
#include "renderer/interchange/material_looks.h"
#include "renderer/interchange/surface_welder.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace meristem {

namespace {

constexpr std::size_t most_places = 4'000'000;  // some 100 bytes each

// The new vertices of a piece, with the colours that the materials of their triangles give them in the first place.
class Coloring {
 public:
  Coloring(MaterialLooks& looks, const Affine3d& place) : looks_(looks), place_(place), from_world_(place.inverse()) {}

  std::vector<MeshVertex> vertices_of(const Tessellation& cell, const SurfaceWelder::Piece& piece) {
    std::vector<MeshVertex> vertices(piece.cell_vertices.size());
    const std::vector<Vec2f> uv = vertex_uv(cell);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const std::uint32_t v = piece.cell_vertices[i];
      vertices[i] = {cell.positions[v], cell.attributes[v].normal.unpack(), uv[v], {}};
    }
    std::vector<bool> has_color(vertices.size(), false);
    for (const SurfaceWelder::Triangle& t : piece.triangles)
      for (const std::uint32_t number : t.vertices) {
        if (number < piece.first_vertex || has_color[number - piece.first_vertex]) continue;
        has_color[number - piece.first_vertex] = true;
        MeshVertex& v = vertices[number - piece.first_vertex];
        v.color = looks_.color_at(cell.origins[t.origin], Vec3f(place_.point(Vec3d(v.position))),
                                  Vec3f(normalize(from_world_.transposed_vector(Vec3d(v.normal)))), v.uv);
      }
    return vertices;
  }

 private:
  MaterialLooks& looks_;
  const Affine3d place_, from_world_;
};

std::vector<MeshTriangle> triangles_of(const Tessellation& cell, const SurfaceWelder::Piece& piece,
                                       const MaterialLooks& looks) {
  std::vector<MeshTriangle> triangles;
  triangles.reserve(piece.triangles.size());
  for (const SurfaceWelder::Triangle& t : piece.triangles)
    triangles.push_back({t.vertices, looks.material_of(cell.origins[t.origin])});
  return triangles;
}

// "tree#1a2b": the model's name and its seed; another individual and level of detail has another number behind it.
std::string surface_name(const ShownSurface& surface, std::size_t index) {
  return fmt::format("{}_{}", surface.model->name().substr(0, surface.model->name().find('#')), index);
}

}  // namespace

ExportFigures export_scene(const LoadedScene& scene, MeshWriter& writer,
                           const std::function<void(double done, std::uint64_t triangles)>& progress) {
  const std::vector<ShownSurface> surfaces = shown_surfaces(scene.objects, scene.footprint, most_places);
  ExportFigures figures;
  figures.surfaces = surfaces.size();
  MaterialLooks looks(*scene.scene);
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const ShownSurface& surface = surfaces[i];
    writer.begin(surface_name(surface, i), surface.places);
    figures.places += surface.places.size();
    SurfaceWelder welder;
    Coloring coloring(looks, surface.places[0]);
    for_each_tessellation(surface, [&](const Tessellation& cell, double done) {
      const SurfaceWelder::Piece piece = welder.add(cell);
      const std::vector<MeshVertex> vertices = coloring.vertices_of(cell, piece);
      writer.add(vertices, triangles_of(cell, piece, looks));
      figures.vertices += vertices.size();
      figures.triangles += piece.triangles.size();
      figures.shown_triangles += piece.triangles.size() * surface.places.size();
      progress((double(i) + done) / double(surfaces.size()), figures.shown_triangles);
    });
  }
  const std::vector<MaterialLook> materials = looks.list();
  writer.finish(materials, mesh_camera(*scene.scene));
  std::ranges::copy_if(materials, std::back_inserter(figures.materials), &MaterialLook::is_used);
  return figures;
}

MeshCamera mesh_camera(const Scene& scene) {
  const int width = scene.settings.width, height = scene.settings.height;
  const auto ray = [&](float x, float y) {
    return scene.camera->ray({{x * float(width), y * float(height)}, {0.5f, 0.5f}}, width, height);
  };
  const Ray center = ray(0.5f, 0.5f), top = ray(0.5f, 0), bottom = ray(0.5f, 1);
  const bool is_parallel = top.direction == bottom.direction;
  const Vec3d back = -normalize(Vec3d(center.direction));
  const Vec3d up_there(is_parallel ? top.origin - bottom.origin : top.direction - bottom.direction);
  const Vec3d right = normalize(cross(up_there, back));
  MeshCamera camera;
  camera.to_world = {right, cross(back, right), back, Vec3d(center.origin)};
  constexpr double widest = 170 * pi / 180;  // of what sees all around
  camera.vertical_fov =
      std::min(std::acos(std::clamp(double(dot(top.direction, bottom.direction)), -1.0, 1.0)), widest);
  if (is_parallel) camera.height = length(up_there);
  camera.aspect = double(width) / double(height);
  return camera;
}

std::unique_ptr<MeshWriter> make_mesh_writer(const std::string& path, bool has_colors,
                                             const std::vector<std::string>& material_names) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".obj") return make_obj_writer(path, material_names);
  if (extension == ".ply") return make_ply_writer(path, has_colors);
  if (extension == ".glb") return make_glb_writer(path, has_colors);
  return nullptr;
}

}  // namespace meristem
