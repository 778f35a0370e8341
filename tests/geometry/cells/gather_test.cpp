#include "geometry/cells/gather.h"

#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace meristem {
namespace {

using Faces = std::set<Key>;

// The faces that share a vertex with one of these.
std::set<std::uint32_t> with_neighbours(const Mesh& mesh, const std::set<std::uint32_t>& faces) {
  std::set<std::uint32_t> vertices, result;
  for (std::uint32_t f : faces)
    for (std::uint32_t v : mesh.corners(f)) vertices.insert(v);
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    if (std::ranges::any_of(mesh.corners(f), [&](std::uint32_t v) { return vertices.contains(v); })) result.insert(f);
  return result;
}

Faces keys_of(const Mesh& mesh, const std::set<std::uint32_t>& faces) {
  Faces keys;
  for (std::uint32_t f : faces) keys.insert(mesh.face_keys[f]);
  return keys;
}

void expect_whole_rings(const Mesh& mesh, const std::vector<std::uint32_t>& owned, const char* name) {
  constexpr int rings = 3;
  const CellMesh cell = gather_cell(mesh, VertexFaces(mesh), owned, rings);
  ASSERT_EQ(cell.rings.size(), cell.mesh.face_count()) << name;
  EXPECT_EQ(cell.owned_faces, owned.size());
  std::set<std::uint32_t> within(owned.begin(), owned.end());
  for (int ring = 0; ring <= rings; ++ring) {
    Faces gathered;
    for (std::uint32_t f = 0; f < cell.mesh.face_count(); ++f)
      if (cell.rings[f] <= ring) gathered.insert(cell.mesh.face_keys[f]);
    EXPECT_EQ(gathered, keys_of(mesh, within)) << name << " ring " << ring;
    within = with_neighbours(mesh, within);
  }
  EXPECT_TRUE(std::ranges::is_sorted(cell.rings)) << name;
}

TEST(Gather, HasAllFacesOfEachRing) {
  const Mesh grid = shapes::bumpy_grid(12);
  expect_whole_rings(grid, {65}, "one face");
  expect_whole_rings(grid, {0}, "at a corner");
  expect_whole_rings(grid, {5, 6, 7, 17, 18, 19}, "at a border");
  expect_whole_rings(grid, {30, 100}, "apart");
  expect_whole_rings(shapes::prism(8), {0, 1}, "prism");
}

// Of cells that are the same but for their place the numbering is the same.
TEST(Gather, NumbersByShapeAlone) {
  const Mesh grid = shapes::bumpy_grid(20);
  const VertexFaces faces_around(grid);
  const auto square = [&](std::uint32_t first) {
    std::vector<std::uint32_t> owned;
    for (std::uint32_t i = 0; i < 16; ++i) owned.push_back(first + i % 4 + i / 4 * 20);
    return gather_cell(grid, faces_around, owned, 3).mesh;
  };
  const Mesh a = square(84), b = square(169);
  EXPECT_EQ(a.corner_vertices, b.corner_vertices);
  EXPECT_EQ(a.face_starts, b.face_starts);
  EXPECT_NE(a.face_keys, b.face_keys);
}

}  // namespace
}  // namespace meristem
