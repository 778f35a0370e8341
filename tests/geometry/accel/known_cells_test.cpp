#include "geometry/accel/known_cells.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace meristem {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
const Bounds3f unit_box{Vec3f(0.0f), Vec3f(1.0f)};

RaySpan along_x(float y) { return {{-1, y, 0.5f}, {1, 0, 0}, 0, infinity}; }

TEST(KnownChildren, KeepsTheFirstBoundsAndTheirOutline) {
  KnownChildren known(3);
  EXPECT_FALSE(known.knows(1));
  const std::vector<Bounds3f> boxes{{{0, 0, 0}, {1, 0.2f, 1}}, {{0.5f, 0.8f, 0}, {1, 1, 1}}};
  known.note(1, unit_box, boxes);
  known.note(1, {Vec3f(5.0f), Vec3f(6.0f)}, {});
  EXPECT_TRUE(known.knows(1));
  EXPECT_FALSE(known.knows(0));
  EXPECT_TRUE(known.bounds(1).contains(unit_box));
  EXPECT_LT(known.bounds(1).upper.x, 1.1f);
  EXPECT_NEAR(known.entry(1, along_x(0.1f)), 1, 0.02f);
  EXPECT_NEAR(known.entry(1, along_x(0.9f)), 1.5f, 0.02f);
  EXPECT_EQ(known.entry(1, along_x(0.5f)), infinity) << "between its parts";
}

TEST(KnownCells, OutlastTheirUsersUntilThereAreTooMany) {
  constexpr std::size_t children = 10, kept = 4;
  KnownCells cells(kept * (KnownChildren::bytes(children) + 128));
  const auto knows = [&](Key cell) { return cells.of(cell, children)->knows(0); };
  for (Key cell = 0; cell < kept; ++cell) cells.of(cell, children)->note(0, unit_box, {});
  const std::size_t full = cells.bytes();
  EXPECT_GE(full, kept * KnownChildren::bytes(children));
  for (Key cell = 0; cell < kept; ++cell) EXPECT_TRUE(knows(cell)) << cell;
  const auto used = cells.of(1, children);
  EXPECT_TRUE(knows(0));
  EXPECT_FALSE(knows(7));
  EXPECT_EQ(cells.bytes(), full);
  EXPECT_FALSE(knows(2)) << "asked for longest ago, before 3";
  EXPECT_TRUE(used->knows(0));
  EXPECT_TRUE(knows(0));
  EXPECT_TRUE(knows(1));
}

TEST(KnownCells, WithoutRoomNothingIsKept) {
  KnownCells cells(0);
  cells.of(1, 10)->note(0, unit_box, {});
  EXPECT_FALSE(cells.of(1, 10)->knows(0));
  EXPECT_EQ(cells.bytes(), 0u);
  EXPECT_NE(cells.new_root(), cells.new_root());
}

}  // namespace
}  // namespace meristem
