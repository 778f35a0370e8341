#include "geometry/cells/step.h"

#include "geometry/mesh/rings.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace meristem {
namespace {

TEST(CellOfFaces, KeepsRingsOfTheOthersAsHalo) {
  CellMesh cell;
  cell.mesh = shapes::bumpy_grid(6);
  cell.owned_faces = cell.mesh.face_count();
  for (std::uint32_t f = 0; f < cell.owned_faces; ++f) cell.labels.push_back(100 + f);
  const std::uint32_t corner[] = {0, 1, 6, 7};  // of 2 x 2 faces
  const CellMesh part = cell_of_faces(cell, corner, 2);
  EXPECT_EQ(part.owned_faces, 4u);
  EXPECT_EQ(part.labels, (std::vector<std::uint32_t>{100, 101, 106, 107}));
  ASSERT_EQ(part.mesh.face_count(), 16u);
  EXPECT_EQ(part.mesh.vertex_count(), 25u);
  EXPECT_TRUE(std::ranges::is_sorted(part.rings));
  EXPECT_EQ(std::ranges::count(part.rings, 0), 4);
  EXPECT_EQ(std::ranges::count(part.rings, 1), 5);
  EXPECT_EQ(std::ranges::count(part.rings, 2), 7);
  for (std::uint32_t i = 0; i < 4; ++i) EXPECT_EQ(part.mesh.face_keys[i], cell.mesh.face_keys[corner[i]]);
}

TEST(CellOfFaces, IsTheSameFromTheFacesAroundVertices) {
  CellMesh cell;
  cell.mesh = shapes::bumpy_grid(8);
  cell.owned_faces = cell.mesh.face_count();
  const VertexFaces faces_around(cell.mesh);
  const std::uint32_t faces[] = {9, 10, 17, 63};
  for (int rings = 0; rings <= 3; ++rings) {
    const CellMesh a = cell_of_faces(cell, faces, rings), b = cell_of_faces(cell, faces, rings, faces_around);
    EXPECT_EQ(a.mesh.face_keys, b.mesh.face_keys) << rings;
    EXPECT_EQ(a.mesh.vertex_keys, b.mesh.vertex_keys) << rings;
    EXPECT_EQ(a.rings, b.rings) << rings;
    EXPECT_EQ(a.owned_faces, b.owned_faces);
  }
}

TEST(TrimHalo, DropsVerticesThatNoFaceUses) {
  CellMesh cell;
  cell.mesh = shapes::bumpy_grid(2);
  cell.owned_faces = cell.mesh.face_count();
  const std::uint32_t vertices = cell.mesh.vertex_count();
  trim_halo(cell, 1);
  EXPECT_EQ(cell.mesh.vertex_count(), vertices);
  EXPECT_EQ(cell.rings, std::vector<std::uint8_t>(cell.owned_faces, 0));
  cell.mesh.add_vertex({}, 1);
  trim_halo(cell, 1);
  EXPECT_EQ(cell.mesh.vertex_count(), vertices);
}

}  // namespace
}  // namespace meristem
