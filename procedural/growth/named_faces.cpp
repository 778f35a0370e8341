#include "procedural/growth/named_faces.h"

namespace meristem {

namespace {

// Calls visit(corner, from, to) for every half edge.
template <class Visit>
void for_each_half_edge(const NamedFaces& faces, const Visit& visit) {
  for (std::uint32_t f = 0; f < faces.face_count(); ++f) {
    const auto corners = faces.face(f);
    for (std::size_t i = 0; i < corners.size(); ++i)
      visit(faces.face_starts[f] + i, corners[i], corners[(i + 1) % corners.size()]);
  }
}

}  // namespace

void NamedFaces::crease_inner_edges(float sharpness) {
  for_each_half_edge(*this, [&](std::size_t corner, std::uint32_t from, std::uint32_t to) {
    if (!is_border_edge(from, to)) corner_sharpness[corner] = sharpness;
  });
}

void NamedFaces::crease_edge(std::uint32_t a, std::uint32_t b, float sharpness) {
  for_each_half_edge(*this, [&](std::size_t corner, std::uint32_t from, std::uint32_t to) {
    if ((from == a && to == b) || (from == b && to == a)) corner_sharpness[corner] = sharpness;
  });
}

Mesh bare_mesh(const NamedFaces& faces, std::span<const Vec3d> border) {
  Mesh mesh;
  for (Vec3d p : border) mesh.add_vertex(p, mesh.vertex_count());
  for (Vec3d p : faces.vertices) mesh.add_vertex(p, mesh.vertex_count());
  for (std::uint32_t f = 0; f < faces.face_count(); ++f) mesh.add_face(faces.face(f), f, 0);
  return mesh;
}

}  // namespace meristem
