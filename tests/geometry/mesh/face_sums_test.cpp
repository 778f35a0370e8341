#include "geometry/mesh/face_sums.h"

#include "geometry/base/key.h"
#include "geometry/mesh/refine.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

// Many quads at once give the bits that one at a time gives, also where one has no area and where a block is not full.
TEST(FaceSums, AreThoseOfOneQuadAtATime) {
  const Quantum quantum = Quantum::for_reach(4);
  constexpr std::size_t vertices = 60;
  std::vector<Vec3d> positions;
  for (Key i = 0; i < vertices; ++i)
    positions.push_back(quantum.round(Vec3d{uniform_double(hash_keys(i, 1)), uniform_double(hash_keys(i, 2)),
                                            3 * uniform_double(hash_keys(i, 3)) - 1}));
  for (std::size_t count : {1u, 31u, 32u, 33u, 100u}) {
    std::vector<std::uint32_t> corners;
    for (Key i = 0; i < 4 * count; ++i) corners.push_back(std::uint32_t(hash_keys(i, 4) % vertices));
    for (std::size_t k = 0; k < 4; ++k) corners[k] = 7;  // no area, no diagonal
    std::vector<FaceSum> sums(vertices), expected(vertices);
    add_quads(positions, corners, quantum, sums);
    for (std::size_t f = 0; f < count; ++f) {
      const std::uint32_t* c = &corners[4 * f];
      const Vec3d normal = unit_face_normal(positions, c, 4);
      const double diagonal = quantum.round(0.5 * (length(positions[c[2]] - positions[c[0]]) +  //
                                                   length(positions[c[3]] - positions[c[1]])));
      for (std::size_t k = 0; k < 4; ++k) {
        expected[c[k]].normal += normal;
        expected[c[k]].diagonal += diagonal;
      }
    }
    std::vector<Vec3d> normals(vertices);
    unit_normals(sums, normals.data());
    for (std::size_t v = 0; v < vertices; ++v) {
      EXPECT_EQ(sums[v].normal, expected[v].normal) << count << " quads, vertex " << v;
      EXPECT_EQ(sums[v].diagonal, expected[v].diagonal) << count << " quads, vertex " << v;
      EXPECT_EQ(normals[v], normalize(expected[v].normal)) << count << " quads, vertex " << v;
    }
  }
}

}  // namespace
}  // namespace meristem
