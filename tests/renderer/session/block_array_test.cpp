#include "renderer/session/block_array.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace meristem {
namespace {

TEST(BlockArray, GrowsWithoutMovingAndHoldsLittleMoreThanItNeeds) {
  struct Thing {
    std::uint32_t words[5];
  };
  BlockArray<Thing> things;
  EXPECT_TRUE(things.empty());
  EXPECT_EQ(things.bytes(), 0u);
  constexpr std::size_t count = 100000;
  const Thing* first = nullptr;
  for (std::size_t i = 0; i < count; ++i) {
    ASSERT_EQ(things.grow(), i);
    things[i].words[4] = std::uint32_t(i);
    if (i == 0) first = &things[0];
  }
  EXPECT_EQ(first, &things[0]);
  EXPECT_EQ(things.size(), count);
  for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(things[i].words[4], i);
  EXPECT_GE(things.bytes(), count * sizeof(Thing));
  EXPECT_LT(things.bytes(), count * sizeof(Thing) * 11 / 10);
}

}  // namespace
}  // namespace meristem
