#include "renderer/session/tiles.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <vector>

namespace meristem {
namespace {

TEST(Tiles, CoverEveryPixelOnce) {
  for (const PixelWindow window :
       {PixelWindow{0, 0, 64, 64}, PixelWindow{3, 5, 100, 38}, PixelWindow{0, 0, 1, 1}, PixelWindow{9, 0, 10, 77}})
    for (int side : {1, 7, 16, 500}) {
      std::vector<int> visits(std::size_t(window.width() * window.height()), 0);
      for (const PixelWindow& tile : tiles_along_hilbert_curve(window, side)) {
        EXPECT_FALSE(tile.empty());
        for (int y = tile.y0; y < tile.y1; ++y)
          for (int x = tile.x0; x < tile.x1; ++x)
            ++visits.at(std::size_t((y - window.y0) * window.width() + x - window.x0));
      }
      for (int count : visits) ASSERT_EQ(count, 1);
    }
}

TEST(Tiles, OfAPowerOfTwoFollowEachOtherAlongTheirSides) {
  const std::vector<PixelWindow> tiles = tiles_along_hilbert_curve({0, 0, 256, 256}, 16);
  ASSERT_EQ(tiles.size(), 256u);
  for (std::size_t i = 1; i < tiles.size(); ++i)
    EXPECT_EQ(std::abs(tiles[i].x0 - tiles[i - 1].x0) + std::abs(tiles[i].y0 - tiles[i - 1].y0), 16) << i;
}

}  // namespace
}  // namespace meristem
