#include "geometry/base/motion.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

Motion turning_and_moving() {
  Motion motion;
  for (int i = 0; i <= 4; ++i)
    motion.keys.push_back(Affine3d::translation({double(i), 0, 0}) * Affine3d::rotation({0, 0, 1}, 0.3 * i));
  return motion;
}

TEST(Motion, IsItsKeysAndBetweenThemStraight) {
  const Motion motion = turning_and_moving();
  for (int i = 0; i <= 4; ++i) EXPECT_EQ(motion.at(0.25f * float(i)), motion.keys[std::size_t(i)]);
  const Vec3d p{1, 2, 3};
  const Vec3d from = motion.keys[1].point(p), to = motion.keys[2].point(p);
  EXPECT_LT(length(motion.at(0.4375f).point(p) - (from * 0.25 + to * 0.75)), 1e-12);
}

TEST(Motion, TimesBeforeAndAfterAreItsEnds) {
  const Motion motion = turning_and_moving();
  EXPECT_EQ(motion.at(-1), motion.keys.front());
  EXPECT_EQ(motion.at(2), motion.keys.back());
}

TEST(Motion, BoundsHoldAtAllTimes) {
  const Motion motion = turning_and_moving();
  const Bounds3d box{{-1, -0.5, 0}, {2, 1, 1}}, all = motion.bounds(box).inflated(Vec3d(1e-12));
  for (int i = 0; i <= 100; ++i) EXPECT_TRUE(all.contains(motion.at(0.01f * float(i)).bounds(box))) << i;
}

}  // namespace
}  // namespace meristem
