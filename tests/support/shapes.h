// Small meshes with known properties, for tests.
#pragma once

#include "geometry/mesh/mesh.h"

#include <initializer_list>
#include <vector>

namespace meristem::shapes {

inline Mesh from_faces(std::vector<Vec3d> positions, const std::vector<std::vector<std::uint32_t>>& faces) {
  Mesh mesh;
  for (std::size_t i = 0; i < positions.size(); ++i) mesh.add_vertex(positions[i], hash_keys(1, i));
  mesh.origins = {FaceOrigin{.key = 7}};
  for (std::size_t i = 0; i < faces.size(); ++i) mesh.add_face(faces[i], hash_keys(2, i), 0);
  return mesh;
}

inline Mesh cube(double half = 1) {
  std::vector<Vec3d> p;
  for (int i = 0; i < 8; ++i) p.push_back({i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? half : -half});
  return from_faces(p, {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}});
}

inline Mesh tetrahedron() {
  return from_faces({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}});
}

// A closed prism over the y axis with n sides and n-gon caps.
inline Mesh prism(std::uint32_t n, double radius = 1, double height = 2) {
  std::vector<Vec3d> p;
  std::vector<std::vector<std::uint32_t>> faces(2);
  for (std::uint32_t i = 0; i < 2 * n; ++i) {
    const double a = 2 * pi * (i % n) / n;
    p.push_back({radius * std::cos(a), i < n ? 0 : height, -radius * std::sin(a)});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    faces[0].push_back(n - 1 - i);
    faces[1].push_back(n + i);
    faces.push_back({i, j, n + j, n + i});
  }
  return from_faces(p, faces);
}

// An open square of n x n quads in the xz plane, seen from above, with a bump.
inline Mesh bumpy_grid(std::uint32_t n) {
  std::vector<Vec3d> p;
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) p.push_back({double(i), 0.3 * ((i * 7 + j * 5) % 4), -double(j)});
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i;
      faces.push_back({a, a + 1, a + n + 2, a + n + 1});
    }
  return from_faces(p, faces);
}

inline Mesh icosahedron() {
  const double g = (1 + std::sqrt(5.0)) / 2;
  return from_faces({{-1, g, 0},
                     {1, g, 0},
                     {-1, -g, 0},
                     {1, -g, 0},
                     {0, -1, g},
                     {0, 1, g},
                     {0, -1, -g},
                     {0, 1, -g},
                     {g, 0, -1},
                     {g, 0, 1},
                     {-g, 0, -1},
                     {-g, 0, 1}},
                    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}});
}

// Sets the sharpness of the edge between two vertices on both its faces.
inline void crease(Mesh& mesh, std::uint32_t a, std::uint32_t b, float sharpness) {
  mesh.corner_sharpness.resize(mesh.corner_vertices.size(), 0);
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    for (std::uint32_t k = 0; k < mesh.corner_count(f); ++k) {
      const auto c = mesh.corners(f);
      const std::uint32_t v = c[k], w = c[(k + 1) % c.size()];
      if ((v == a && w == b) || (v == b && w == a)) mesh.corner_sharpness[mesh.face_starts[f] + k] = sharpness;
    }
}

}  // namespace meristem::shapes
