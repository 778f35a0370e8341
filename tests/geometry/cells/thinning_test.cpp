#include "geometry/cells/thinning.h"

#include <gtest/gtest.h>

#include <cmath>

namespace meristem {
namespace {

TEST(Thinning, WhatIsLargeEnoughStaysAsItIs) {
  for (double size : {1.0, 1.5, 100.0})
    for (double random : {0.0, 0.5, 0.999999}) {
      EXPECT_TRUE(thin(size, random).is_kept);
      EXPECT_EQ(thin(size, random).enlargement, 1);
    }
}

TEST(Thinning, AreasStayInTheMean) {
  constexpr int count = 100000;
  for (double size = 0.999; size > 1 / largest_enlargement; size *= 0.8) {
    double area = 0, kept = 0;
    for (int i = 0; i < count; ++i) {
      const Thinned t = thin(size, (i + 0.5) / count);
      kept += t.is_kept;
      if (t.is_kept) area += t.enlargement * t.enlargement;
    }
    EXPECT_NEAR(area / count, 1, 2e-3) << size;
    EXPECT_NEAR(kept / count, std::min(size * size / 0.75, 1.0), 0.02) << size;
  }
}

// The nearer, the more: none that was there goes, and none comes in that is seen at once.
TEST(Thinning, NothingJumpsWhileTheSizeGrows) {
  for (int i = 0; i < 1000; ++i) {
    const double random = (i + 0.5) / 1000;
    bool was_kept = false;
    double was_seen = 0;
    for (double size = 0.02; size < 1.1; size *= 1.001) {
      const Thinned t = thin(size, random);
      const double seen = t.is_kept ? size * t.enlargement : 0;  // in wanted sizes
      EXPECT_TRUE(t.is_kept || !was_kept) << size << " " << random;
      // A step is a thousandth of the size. Of what comes in, a quarter of it is seen at once
      EXPECT_LT(std::abs(seen - was_seen), t.is_kept == was_kept ? 0.1 : 0.27) << size << " " << random;
      if (t.is_kept) {
        EXPECT_GE(t.enlargement, smallest_enlargement);
        EXPECT_LE(t.enlargement, largest_enlargement);
      }
      was_kept = t.is_kept;
      was_seen = seen;
    }
    EXPECT_TRUE(was_kept);
  }
}

TEST(Thinning, OfWhatIsAsSmallAsAnythingSomeRemain) {
  int kept = 0;
  for (int i = 0; i < 10000; ++i) kept += thin(1e-9, (i + 0.5) / 10000).is_kept;
  EXPECT_NEAR(kept, 10000 / 56, 2);
}

}  // namespace
}  // namespace meristem
