#include "geometry/base/bounds.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

TEST(Bounds, BeginEmptyAndGrow) {
  Bounds3d b;
  EXPECT_TRUE(b.empty());
  EXPECT_EQ(b.diagonal(), 0);
  b.extend(Vec3d(1, 2, 3));
  EXPECT_FALSE(b.empty());
  EXPECT_EQ(b.size(), Vec3d(0.0));
  b.extend(Vec3d(-1, 4, 3));
  EXPECT_EQ(b.lower, Vec3d(-1, 2, 3));
  EXPECT_EQ(b.upper, Vec3d(1, 4, 3));
  EXPECT_EQ(b.center(), Vec3d(0, 3, 3));
  EXPECT_DOUBLE_EQ(b.diagonal(), std::sqrt(8.0));
}

TEST(Bounds, ExtendByEmptyChangesNothing) {
  Bounds3d b{Vec3d(0.0), Vec3d(1.0)};
  b.extend(Bounds3d{});
  EXPECT_EQ(b.lower, Vec3d(0.0));
  EXPECT_EQ(b.upper, Vec3d(1.0));
}

TEST(Bounds, ContainTheirFacesAndTheEmptyBox) {
  const Bounds3d unit{Vec3d(0.0), Vec3d(1.0)};
  EXPECT_TRUE(unit.contains(Vec3d(1, 0, 0.5)));
  EXPECT_FALSE(unit.contains(Vec3d(1.0000001, 0, 0)));
  EXPECT_TRUE(unit.contains(unit));
  EXPECT_TRUE(unit.contains(Bounds3d{}));
  EXPECT_FALSE(unit.contains(unit.inflated(Vec3d(0, 1e-9, 0))));
  EXPECT_TRUE(unit.inflated(Vec3d(0.5)).contains(Vec3d(-0.5, 1.5, 0)));
  EXPECT_FALSE(unit.contains(Vec3d(std::nan(""), 0, 0)));
}

TEST(Bounds, RoundOutwardsByLessThanOneUlp) {
  for (double x : {0.1, -0.1, 1.0, 1e-30, -1e30, 1.0 / 3, -2.0 / 3}) {
    const Bounds3f b = round_outwards({Vec3d(x), Vec3d(x)});
    EXPECT_LE(double(b.lower.x), x);
    EXPECT_GE(double(b.upper.x), x);
    EXPECT_LE(b.upper.x, std::nextafterf(b.lower.x, INFINITY));
  }
  EXPECT_EQ(round_outwards({Vec3d(0.5), Vec3d(2.0)}).lower, Vec3f(0.5f));  // exact numbers stay
}

}  // namespace
}  // namespace meristem
