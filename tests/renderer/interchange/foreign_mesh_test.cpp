#include "renderer/interchange/foreign_mesh.h"

#include "geometry/base/key.h"
#include "geometry/mesh/mesh.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

std::string defect_of(const PolygonMesh& polygons) {
  Mesh mesh;
  for (std::size_t i = 0; i < polygons.positions.size(); ++i) mesh.add_vertex(polygons.positions[i], Key(i));
  mesh.origins = {FaceOrigin{}};
  for (std::uint32_t f = 0; f < polygons.face_count(); ++f)
    mesh.add_face({polygons.corner_positions.data() + polygons.face_starts[f],
                   polygons.face_starts[f + 1] - polygons.face_starts[f]},
                  Key(f), 0);
  return manifold_defect(mesh);
}

ForeignMesh quad_of_two_triangles() {
  ForeignMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.uv = {{0, 0}, {1, 0}, {1, 1}, {5, 0}, {6, 1}, {5, 1}};
  mesh.add_face({0, 1, 2});
  mesh.add_face({3, 4, 5});
  return mesh;
}

TEST(ForeignMesh, NormalsDecideWhatIsWelded) {
  MeshRepairs repairs;
  ForeignMesh mesh = quad_of_two_triangles();
  EXPECT_EQ(to_polygon_mesh(mesh, repairs).positions.size(), 6u) << "flat faces have vertices of their own";
  mesh.normals.assign(6, {0, 0, 1});
  const PolygonMesh smooth = to_polygon_mesh(mesh, repairs);
  EXPECT_EQ(smooth.positions.size(), 4u);
  EXPECT_EQ(smooth.uv[smooth.corner_uv[3]], (Vec2d{5, 0})) << "texture coordinates stay those of the corners";
  EXPECT_EQ(repairs.degenerate + repairs.cut, 0u);
  mesh.normals[3] = {0, 1, 0};
  EXPECT_EQ(to_polygon_mesh(mesh, repairs).positions.size(), 6u) << "what then meets in a point alone is cut";
}

TEST(ForeignMesh, FacesWithoutAreaAreLeftOut) {
  MeshRepairs repairs;
  ForeignMesh mesh = quad_of_two_triangles();
  mesh.normals.assign(6, {0, 0, 1});
  mesh.add_face({0, 1, 1});
  mesh.add_face({0, 3, 1});
  EXPECT_EQ(to_polygon_mesh(mesh, repairs).face_count(), 2u);
  EXPECT_EQ(repairs.degenerate, 2u);
}

TEST(ForeignMesh, WhatIsNoManifoldIsCutUntilItIs) {
  MeshRepairs repairs;
  ForeignMesh mesh;
  for (int i = 0; i < 8; ++i) mesh.positions.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2)});
  mesh.normals.assign(8, {});
  mesh.add_face({0, 1, 2});
  mesh.add_face({1, 0, 4});  // three faces at one edge,
  mesh.add_face({0, 1, 7});  // two of them in one direction,
  mesh.add_face({2, 5, 6});  // and a face that touches another in a point
  PolygonMesh cut = to_polygon_mesh(mesh, repairs);
  EXPECT_EQ(defect_of(cut), "");
  EXPECT_GT(repairs.cut, 0u);
  EXPECT_EQ(cut.face_count(), 4u);
}

// Faces at random over few points: all kinds of defects.
TEST(ForeignMesh, AnySoupBecomesAManifold) {
  for (Key k = 0; k < 300; ++k) {
    ForeignMesh mesh;
    for (Key i = 0; i < 6; ++i)
      mesh.positions.push_back(
          {uniform_double(hash_keys(k, i, 1)), uniform_double(hash_keys(k, i, 2)), uniform_double(hash_keys(k, i, 3))});
    mesh.normals.assign(6, {});
    for (Key f = 0; f < 3 + k % 12; ++f) {
      const auto corner = [&](Key c) { return std::uint32_t(hash_keys(k, f, c, 4) % 6); };
      mesh.add_face({corner(0), corner(1), corner(2)});
    }
    MeshRepairs repairs;
    const PolygonMesh cut = to_polygon_mesh(mesh, repairs);
    ASSERT_EQ(defect_of(cut), "") << k;
    ASSERT_EQ(cut.face_count() + repairs.degenerate, 3 + k % 12);
  }
}

}  // namespace
}  // namespace meristem
