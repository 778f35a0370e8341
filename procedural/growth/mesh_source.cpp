#include "procedural/growth/mesh_source.h"

#include "geometry/io/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

namespace meristem {

namespace {

constexpr const char* points_schema =
    R"({"type":"array","items":{"type":"array","items":{"type":"number"},"minItems":3,"maxItems":3}})";
constexpr const char* uv_schema =
    R"({"type":"array","items":{"type":"array","items":{"type":"number"},"minItems":2,"maxItems":2}})";
constexpr const char* polygons_schema =
    R"({"type":"array","items":{"type":"array","items":{"type":"integer","minimum":0},"minItems":3}})";
constexpr const char* names_schema = R"({"type":"array","items":{"type":"string"}})";

// Calls visit(item) for the items of an array; an error if it is none.
template <class Visit>
void for_each_item(const Value& list, Diagnostics& diagnostics, const Visit& visit) {
  if (list.kind != Value::Kind::Array) {
    diagnostics.error(list.location, fmt::format("expected an array, found {}", list.kind_name()));
    return;
  }
  for (const Value& item : list.items) visit(item);
}

// The `count` finite numbers of an array; nothing, and an error, if it is not that.
std::optional<Vec3d> read_tuple(const Value& item, std::size_t count, Diagnostics& diagnostics) {
  Vec3d result;
  bool good = item.kind == Value::Kind::Array && item.items.size() == count;
  for (std::size_t i = 0; good && i < count; ++i) {
    good = item.items[i].kind == Value::Kind::Number && std::isfinite(item.items[i].number);
    result[int(i)] = item.items[i].number;
  }
  if (good) return result;
  diagnostics.error(item.location, fmt::format("expected {} numbers in brackets", count));
  return std::nullopt;
}

bool is_index(const Value& v, std::size_t count) {
  return v.kind == Value::Kind::Number && v.number >= 0 && v.number < double(count) && v.number == std::floor(v.number);
}

bool stays_inside(const std::string& file) {
  const std::filesystem::path path = std::filesystem::path(file).lexically_normal();
  return path.is_relative() && !path.empty() && *path.begin() != "..";
}

}  // namespace

int index_of_name(std::vector<std::string>& names, const std::string& name) {
  const auto known = std::find(names.begin(), names.end(), name);
  if (known != names.end()) return int(known - names.begin());
  names.push_back(name);
  return int(names.size()) - 1;
}

MeshSource::MeshSource(Params& params) {
  file_ = params.text("file", "",
                      "an OBJ or PLY file beside the scene, instead of vertices and polygons; groups are the names");
  const Value* vertices = params.raw("vertices", false, points_schema, "positions");
  const Value* polygons =
      params.raw("polygons", false, polygons_schema, "indices of vertices, counter-clockwise seen from outside");
  const Value* names = params.raw("names", false, names_schema, "of the polygons, in their order");
  const Value* uv = params.raw("uv", false, uv_schema, "texture coordinates of the vertices");
  if (params.describing()) return;
  location_ = params.location();
  if (!file_.empty()) {
    location_ = params.location_of("file");
    if (!stays_inside(file_)) params.error("file", "a mesh file must lie in the scene's folder or below it");
    if (vertices || polygons) params.error("file", "a mesh has either a \"file\" or \"vertices\" and \"polygons\"");
    return;
  }
  if (!vertices || !polygons) {
    params.diagnostics().error(location_, "a mesh needs a \"file\", or \"vertices\" and \"polygons\"");
    return;
  }
  read_vertices(*vertices, params.diagnostics());
  if (uv) read_uv(*uv, params.diagnostics());
  read_polygons(*polygons, names, params.diagnostics());
}

void MeshSource::read_vertices(const Value& list, Diagnostics& diagnostics) {
  for_each_item(list, diagnostics, [&](const Value& item) {
    if (const auto p = read_tuple(item, 3, diagnostics)) inline_.faces.add_vertex(*p);
  });
}

void MeshSource::read_uv(const Value& list, Diagnostics& diagnostics) {
  for_each_item(list, diagnostics, [&](const Value& item) {
    if (const auto p = read_tuple(item, 2, diagnostics)) uv_.push_back({p->x, p->y});
  });
  inline_.has_uv = uv_.size() == inline_.faces.vertices.size();
  if (!inline_.has_uv)
    diagnostics.error(list.location, fmt::format("expected one u, v for each of the {} vertices, found {}",
                                                 inline_.faces.vertices.size(), uv_.size()));
}

void MeshSource::read_polygons(const Value& list, const Value* names, Diagnostics& diagnostics) {
  const std::size_t vertex_count = inline_.faces.vertices.size();
  for_each_item(list, diagnostics, [&](const Value& item) {
    bool good = item.kind == Value::Kind::Array && item.items.size() >= 3;
    for (std::size_t i = 0; good && i < item.items.size(); ++i) good = is_index(item.items[i], vertex_count);
    if (!good)
      return diagnostics.error(item.location,
                               fmt::format("expected the indices, 0 to {}, of 3 or more vertices", vertex_count - 1));
    const std::size_t index = inline_.faces.face_count();
    const bool named = names && names->kind == Value::Kind::Array && index < names->items.size();
    for (const Value& corner : item.items) {
      const auto v = std::uint32_t(corner.number);
      inline_.faces.add_corner(v, inline_.has_uv ? uv_[v] : Vec2d{});
    }
    inline_.faces.end_face(index_of_name(inline_.names, named ? names->items[index].text : ""));
  });
}

NamedMesh MeshSource::load_file(const std::string& folder, Diagnostics& diagnostics) const {
  const PolygonMesh mesh = load_mesh((std::filesystem::path(folder) / file_).string(), location_, diagnostics);
  report_conflict(mesh, diagnostics);
  if (!mesh.colors.empty())
    diagnostics.warning(location_,
                        fmt::format("the colours of the vertices of \"{}\" are not shown: `meristem convert` makes a "
                                    "scene of such a file that has them",
                                    file_));
  NamedMesh result;
  result.faces.vertices = mesh.positions;
  result.names = mesh.names;
  // Faces without lie at (0, 0), where others have some
  result.has_uv = std::ranges::any_of(mesh.corner_uv, [](std::uint32_t uv) { return uv != PolygonMesh::none; });
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    for (std::uint32_t c = mesh.face_starts[f]; c < mesh.face_starts[f + 1]; ++c)
      result.faces.add_corner(mesh.corner_positions[c],
                              mesh.corner_uv[c] != PolygonMesh::none ? mesh.uv[mesh.corner_uv[c]] : Vec2d{});
    result.faces.end_face(int(mesh.face_names[f]));
  }
  return result;
}

// In the words and at the place of the file, whose vertices count from 1.
void MeshSource::report_conflict(const PolygonMesh& mesh, Diagnostics& diagnostics) const {
  if (mesh.face_places.size() != mesh.face_count()) return;
  const auto conflict = mesh.first_conflict();
  if (!conflict) return;
  diagnostics.error(
      {mesh.text, mesh.face_places[conflict->face]},
      fmt::format("this face goes along the edge from vertex {} to {}, as that of line {} does: faces that meet there "
                  "are turned against each other, or more than two; `meristem convert` cuts such meshes apart",
                  conflict->from + 1, conflict->to + 1,
                  Location{mesh.text, mesh.face_places[conflict->earlier_face]}.line()));
}

NamedMesh MeshSource::load(const std::string& folder, Diagnostics& diagnostics) const {
  if (!file_.empty() && !stays_inside(file_)) return {};  // reported when it was read
  const std::size_t errors_before = diagnostics.errors_found();
  NamedMesh result = file_.empty() ? inline_ : load_file(folder, diagnostics);
  if (diagnostics.errors_found() > errors_before) return {};
  const std::string defect = manifold_defect(bare_mesh(result.faces));
  if (defect.empty()) return result;
  diagnostics.error(location_, fmt::format("the mesh is not a manifold: {}{}", defect,
                                           file_.empty() ? "" : "; `meristem convert` cuts such files apart"));
  return {};
}

}  // namespace meristem
