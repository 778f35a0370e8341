// NamedFaces: a small list of polygons with names, the common form of what a template adds to a mesh and of a base
// mesh.
//
// Vertices [0, border_count) are the corners of the face that is replaced (none for a base mesh); the new ones follow.
// Faces run counter-clockwise seen from outside. Each corner has its own u, v. Plain data.
#pragma once

#include "geometry/mesh/mesh.h"

#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

namespace meristem {

struct NamedFaces {
  std::uint32_t border_count = 0;
  std::vector<Vec3d> vertices;  // the new ones: vertex border_count + i is vertices[i]
  std::vector<std::uint32_t> face_starts{0};
  std::vector<std::uint32_t> corners;
  std::vector<Vec2d> corner_uv;
  std::vector<float> corner_sharpness;  // of the edge from this corner to the next; both faces of an edge agree
  std::vector<int> names;               // one a face: an index into the names of the template or base

  // Empties the list but keeps its memory.
  void clear(std::uint32_t border) {
    border_count = border;
    vertices.clear();
    face_starts.assign(1, 0);
    corners.clear();
    corner_uv.clear();
    corner_sharpness.clear();
    names.clear();
  }
  std::uint32_t face_count() const { return std::uint32_t(names.size()); }
  std::uint32_t vertex_count() const { return border_count + std::uint32_t(vertices.size()); }
  std::span<const std::uint32_t> face(std::uint32_t f) const {
    return {corners.data() + face_starts[f], face_starts[f + 1] - face_starts[f]};
  }

  std::uint32_t add_vertex(Vec3d position) {
    vertices.push_back(position);
    return vertex_count() - 1;
  }
  // A face corner by corner: add_corner for each, then end_face.
  void add_corner(std::uint32_t vertex, Vec2d uv) {
    corners.push_back(vertex);
    corner_uv.push_back(uv);
    corner_sharpness.push_back(0);
  }
  void end_face(int name) {
    face_starts.push_back(std::uint32_t(corners.size()));
    names.push_back(name);
  }
  void add_face(int name, std::initializer_list<std::uint32_t> vertex_list, std::initializer_list<Vec2d> uv_list) {
    auto uv = uv_list.begin();
    for (std::uint32_t v : vertex_list) add_corner(v, *uv++);
    end_face(name);
  }

  // Sets the sharpness of every edge that does not lie on the border (an edge between two of its vertices that follow
  // each other there belongs to the replaced face's neighbour too, which keeps what it has).
  void crease_inner_edges(float sharpness);
  // Sets the sharpness of the edge a b on both its faces.
  void crease_edge(std::uint32_t a, std::uint32_t b, float sharpness);
  bool is_border_edge(std::uint32_t from, std::uint32_t to) const {
    return from < border_count && to == (from + 1) % border_count;
  }
};

// The faces as a mesh with positions and faces alone; the border's corners stand first, at the given positions.
Mesh bare_mesh(const NamedFaces& faces, std::span<const Vec3d> border = {});

}  // namespace meristem
