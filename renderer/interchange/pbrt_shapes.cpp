#include "renderer/interchange/pbrt_shapes.h"

#include "geometry/io/mesh_file.h"
#include "renderer/language/json_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

constexpr int sphere_divisions = 32;  // 6,144 quadrilaterals: within 0.1 % of the radius
constexpr int disk_sides = 96;

void reverse_faces(ForeignMesh& mesh) {
  for (std::size_t f = 0; f + 1 < mesh.face_starts.size(); ++f)
    std::reverse(mesh.corners.begin() + mesh.face_starts[f], mesh.corners.begin() + mesh.face_starts[f + 1]);
}

std::optional<PbrtShape> finish(ForeignMesh mesh, bool is_reversed, const Location& where, Diagnostics& diagnostics) {
  if (is_reversed) reverse_faces(mesh);
  MeshRepairs repairs;
  PbrtShape shape;
  shape.model.mesh = to_polygon_mesh(mesh, repairs);
  repairs.report(where, diagnostics);
  if (shape.model.mesh->face_count() > 0) return shape;
  diagnostics.warning(where, "a mesh without faces was left out");
  return std::nullopt;
}

// Positions, normals and u, v of the parameters.
ForeignMesh read_vertices(PbrtParameters& params, const Location& where, Diagnostics& diagnostics) {
  ForeignMesh mesh;
  mesh.positions = params.points("P");
  for (const Vec3d n : params.points("N")) mesh.normals.push_back(Vec3f(n));
  mesh.uv = params.pairs("uv");
  if (mesh.uv.empty()) mesh.uv = params.pairs("st");
  const auto fits = [&](std::size_t count, const char* name) {
    if (count == 0 || count == mesh.positions.size()) return true;
    diagnostics.error(where,
                      fmt::format("there are {} values of {} for {} vertices", count, name, mesh.positions.size()));
    return false;
  };
  if (!fits(mesh.normals.size(), "N")) mesh.normals.clear();
  if (!fits(mesh.uv.size(), "uv")) mesh.uv.clear();
  return mesh;
}

// Faces of `count` corners each; the order of the corners as given.
ForeignMesh read_faces(PbrtParameters& params, std::initializer_list<std::uint32_t> order, const Location& where,
                       Diagnostics& diagnostics) {
  ForeignMesh mesh = read_vertices(params, where, diagnostics);
  std::vector<std::uint32_t> indices = params.indices("indices", mesh.positions.size());
  if (!params.find("indices"))
    for (std::uint32_t i = 0; i < mesh.positions.size() && i < order.size(); ++i) indices.push_back(i);
  if (indices.size() % order.size() != 0)
    diagnostics.error(where, fmt::format("the number of indices is no multiple of {}", order.size()));
  for (std::size_t i = 0; i + order.size() <= indices.size(); i += order.size()) {
    for (const std::uint32_t corner : order) mesh.corners.push_back(indices[i + corner]);
    mesh.face_starts.push_back(std::uint32_t(mesh.corners.size()));
  }
  return mesh;
}

std::optional<PbrtShape> read_ply_shape(PbrtParameters& params, const std::string& folder, bool is_reversed,
                                        const Location& where, Diagnostics& diagnostics) {
  const std::string file = params.text("filename", ""), path = path_inside(folder, file);
  if (path.empty() || !file.ends_with(".ply")) {
    diagnostics.error(where, fmt::format("the mesh \"{}\" is no .ply file in the folder of the scene", file));
    return std::nullopt;
  }
  const PolygonMesh read = load_mesh(path, where, diagnostics);
  if (read.face_count() == 0) return std::nullopt;
  ForeignMesh mesh;
  mesh.positions = read.positions;
  mesh.corners = read.corner_positions;
  mesh.face_starts = read.face_starts;
  if (read.uv.size() == read.positions.size()) mesh.uv = read.uv;
  mesh.normals.assign(mesh.positions.size(), Vec3f{});  // smooth where vertices are shared
  return finish(std::move(mesh), is_reversed, where, diagnostics);
}

// Around z, at a height on it.
ForeignMesh disk(double radius, double inner, double height) {
  ForeignMesh mesh;
  const bool is_ring = inner > 0;
  if (!is_ring) mesh.positions.push_back({0, 0, height});
  for (int i = 0; i < disk_sides; ++i) {
    const double angle = 2 * pi * i / disk_sides;
    const Vec3d direction{std::cos(angle), std::sin(angle), 0};
    mesh.positions.push_back(direction * radius + Vec3d{0, 0, height});
    if (is_ring) mesh.positions.push_back(direction * inner + Vec3d{0, 0, height});
  }
  for (std::uint32_t i = 0; i < disk_sides; ++i) {
    const std::uint32_t j = (i + 1) % disk_sides;
    if (is_ring)
      mesh.add_face({2 * i, 2 * j, 2 * j + 1, 2 * i + 1});
    else
      mesh.add_face({0, 1 + i, 1 + j});
  }
  mesh.normals.assign(mesh.positions.size(), Vec3f{0, 0, 1});
  return mesh;
}

}  // namespace

std::optional<PbrtShape> read_pbrt_shape(const std::string& type, PbrtParameters& params, const std::string& folder,
                                         bool is_reversed, const Location& where, Diagnostics& diagnostics) {
  if (type == "trianglemesh")
    return finish(read_faces(params, {0, 1, 2}, where, diagnostics), is_reversed, where, diagnostics);
  if (type == "bilinearmesh")
    return finish(read_faces(params, {0, 1, 3, 2}, where, diagnostics), is_reversed, where, diagnostics);
  if (type == "plymesh") return read_ply_shape(params, folder, is_reversed, where, diagnostics);
  if (type == "loopsubdiv") {
    ForeignMesh mesh = read_faces(params, {0, 1, 2}, where, diagnostics);
    mesh.normals.assign(mesh.positions.size(), Vec3f{});
    auto shape = finish(std::move(mesh), is_reversed, where, diagnostics);
    if (shape)
      shape->model.steps = {json::object({{"subdivide", json::number(std::clamp(params.integer("levels", 3), 1, 8))},
                                          {"scheme", json::text("loop")}})};
    return shape;
  }
  if (type == "disk") {
    const double radius = params.number("radius", 1);
    return finish(disk(radius, params.number("innerradius", 0), params.number("height", 0)), is_reversed, where,
                  diagnostics);
  }
  if (type == "sphere") {
    PbrtShape shape;
    shape.model.base = json::object({{"type", json::text("sphere")}, {"divisions", json::number(sphere_divisions)}});
    shape.to_object = Affine3d::scaling(Vec3d(2 * params.number("radius", 1)));  // of a base of radius 0.5
    return shape;
  }
  diagnostics.warning(where, fmt::format("the shape \"{}\" was left out", type));
  return std::nullopt;
}

}  // namespace meristem
