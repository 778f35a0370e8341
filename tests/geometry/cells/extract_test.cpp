// Cutting parts out of a mesh, whole or with arrays packed.
#include "geometry/cells/extract.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

// A prism whose corners have u, v of their own at some vertices, and whose faces have origins.
Mesh decorated_prism() {
  Mesh mesh = shapes::prism(7);
  mesh.corner_uv.clear();
  for (std::size_t c = 0; c < mesh.corner_vertices.size(); ++c) {
    const double v = mesh.corner_vertices[c];
    mesh.corner_uv.push_back({v, c % 3 == 0 ? double(c) : v});
  }
  mesh.origins.clear();
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    mesh.face_origins[f] = f;
    mesh.origins.push_back({hash_keys(3, f), 0, std::int16_t(f % 2), 0, {float(f % 4)}});
  }
  return mesh;
}

void expect_same(const Mesh& a, const Mesh& b) {
  EXPECT_EQ(a.face_starts, b.face_starts);
  EXPECT_EQ(a.corner_vertices, b.corner_vertices);
  EXPECT_EQ(a.face_keys, b.face_keys);
  EXPECT_EQ(a.face_origins, b.face_origins);
  EXPECT_EQ(a.corner_uv, b.corner_uv);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.origins, b.origins);
}

TEST(Extract, PackedArraysGiveTheSameParts) {
  const Mesh mesh = decorated_prism();
  Mesh rest = mesh;
  const PackedArrays packed = PackedArrays::out_of(rest);
  EXPECT_TRUE(rest.origins.empty() && rest.corner_uv.empty());
  expect_same(packed.back_in(rest), mesh);
  const std::vector<std::uint32_t> faces{3, 0, 5};
  expect_same(extract_faces(rest, packed, faces), extract_faces(mesh, faces));
}

TEST(Extract, AMeshWithoutUvHasNoneToPack) {
  Mesh mesh = decorated_prism();
  mesh.corner_uv.clear();
  Mesh rest = mesh;
  const PackedArrays packed = PackedArrays::out_of(rest);
  EXPECT_TRUE(packed.corner_uv.empty());
  expect_same(packed.back_in(rest), mesh);
}

}  // namespace
}  // namespace meristem
