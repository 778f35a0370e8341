#include "geometry/cells/face_blocks.h"

#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <map>

namespace meristem {
namespace {

TEST(FaceBlocks, OfAnEvenGroundHoldSquaresOfFaces) {
  Mesh grid = shapes::bumpy_grid(12);
  for (Vec3d& p : grid.positions) p.y = 0;
  const FaceBlocks blocks(grid, 4);
  std::map<FaceBlock, std::vector<std::uint32_t>> faces;
  for (std::uint32_t f = 0; f < grid.face_count(); ++f) faces[blocks.of(f)].push_back(f);
  EXPECT_EQ(faces.size(), 9u);
  for (const auto& [block, list] : faces) {
    ASSERT_EQ(list.size(), 16u);
    for (std::uint32_t i = 0; i < 16; ++i) EXPECT_EQ(list[i], list[0] + i % 4 + i / 4 * 12);
  }
}

}  // namespace
}  // namespace meristem
