#include "geometry/mesh/mesh.h"

#include "geometry/mesh/adjacency.h"

#include <fmt/format.h>

#include <algorithm>

namespace meristem {

namespace {

// Whether the faces around vertex v form one fan (a disk or a half disk): walks from face to face over shared edges.
bool is_single_fan(const Adjacency& adjacency, std::uint32_t v) {
  const auto faces = adjacency.faces_of_vertex(v);
  std::vector<std::uint32_t> reached{faces.front()};
  for (std::size_t i = 0; i < reached.size(); ++i) {
    for (std::uint32_t e : adjacency.edges_of_vertex(v)) {
      const Adjacency::Edge& edge = adjacency.edge(e);
      if (edge.faces[1] == Adjacency::none) continue;
      for (int side = 0; side < 2; ++side)
        if (edge.faces[side] == reached[i] &&
            std::find(reached.begin(), reached.end(), edge.faces[1 - side]) == reached.end())
          reached.push_back(edge.faces[1 - side]);
    }
  }
  return reached.size() == faces.size();
}

std::string face_defect(const Mesh& mesh, std::uint32_t f) {
  const auto corners = mesh.corners(f);
  if (corners.size() < 3) return fmt::format("face {} has {} corners", f, corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i] >= mesh.vertex_count())
      return fmt::format("face {} names vertex {} of {}", f, corners[i], mesh.vertex_count());
    for (std::size_t j = i + 1; j < corners.size(); ++j)
      if (corners[i] == corners[j]) return fmt::format("face {} has vertex {} twice", f, corners[i]);
  }
  return {};
}

}  // namespace

namespace {

// Calls visit(list) for every array of a mesh.
template <class Mesh, class Visit>
void for_each_array(Mesh& m, const Visit& visit) {
  const auto all = [&](auto&... lists) { (visit(lists), ...); };
  all(m.face_starts, m.corner_vertices, m.face_keys, m.face_origins, m.enlargements, m.seam_widths, m.corner_uv,
      m.corner_sharpness, m.positions, m.vertex_keys, m.uv, m.vertex_sharpness, m.nominal_scale, m.frozen, m.fading,
      m.origins);
}

}  // namespace

std::size_t Mesh::bytes() const {
  std::size_t sum = 0;
  for_each_array(*this, [&](const auto& list) { sum += list.capacity() * sizeof(list[0]); });
  return sum;
}

void Mesh::shrink_to_fit() {
  for_each_array(*this, [](auto& list) { list.shrink_to_fit(); });
}

std::uint32_t Mesh::add_face(std::span<const std::uint32_t> vertices, Key key, std::uint32_t origin) {
  corner_vertices.insert(corner_vertices.end(), vertices.begin(), vertices.end());
  face_starts.push_back(std::uint32_t(corner_vertices.size()));
  face_keys.push_back(key);
  face_origins.push_back(origin);
  return face_count() - 1;
}

std::uint32_t Mesh::add_vertex(Vec3d position, Key key) {
  positions.push_back(position);
  vertex_keys.push_back(key);
  return vertex_count() - 1;
}

Vec3d newell_normal(const Mesh& mesh, std::uint32_t face) {
  const auto corners = mesh.corners(face);
  const Vec3d origin = mesh.positions[corners[0]];
  Vec3d normal;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    normal += cross(mesh.positions[corners[i]] - origin, mesh.positions[corners[i + 1]] - origin);
  return normal;
}

FaceFrame face_frame(const Mesh& mesh, std::uint32_t face) {
  const auto corners = mesh.corners(face);
  FaceFrame frame;
  for (std::uint32_t v : corners) frame.origin += mesh.positions[v];
  frame.origin /= double(corners.size());
  for (std::uint32_t v : corners) frame.radius += length(mesh.positions[v] - frame.origin);
  frame.radius /= double(corners.size());

  frame.z = normalize(newell_normal(mesh, face));
  if (frame.z == Vec3d{}) frame.z = {0, 1, 0};
  const Vec3d to_edge = (mesh.positions[corners[0]] + mesh.positions[corners[1]]) * 0.5 - frame.origin;
  frame.x = normalize(to_edge - frame.z * dot(to_edge, frame.z));
  if (frame.x == Vec3d{}) orthonormal_basis(frame.z, frame.x, frame.y);
  frame.y = cross(frame.z, frame.x);
  return frame;
}

std::string manifold_defect(const Mesh& mesh) {
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
    if (!is_finite(mesh.positions[v])) return fmt::format("vertex {} is not finite", v);
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    if (std::string defect = face_defect(mesh, f); !defect.empty()) return defect;

  const Adjacency adjacency(mesh);
  if (!adjacency.defect().empty()) return adjacency.defect();
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
    if (!adjacency.faces_of_vertex(v).empty() && !is_single_fan(adjacency, v))
      return fmt::format("vertex {} joins more than one fan of faces", v);
  return {};
}

bool is_closed(const Mesh& mesh) {
  const Adjacency adjacency(mesh);
  for (std::uint32_t e = 0; e < adjacency.edge_count(); ++e)
    if (adjacency.edge(e).faces[1] == Adjacency::none) return false;
  return mesh.face_count() > 0;
}

}  // namespace meristem
