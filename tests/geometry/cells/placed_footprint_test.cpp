#include "geometry/cells/placed_footprint.h"

#include "tests/support/point_footprint.h"
#include "tests/support/test_model.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

// What follows from bounds on a footprint is what a look at the footprint itself decides.
TEST(PlacedFootprint, BoundsDecideAsTheFootprintItself) {
  const auto part = std::make_shared<const Part>(bumpy_model(shapes::cube(), 2, 0.2));
  const auto footprint = std::make_shared<const PointFootprint>(Vec3d(0), 0.001);
  int decided = 0, stand_ins = 0;
  for (Key i = 0; i < 2000; ++i) {
    const auto random = [&](Key what) { return uniform_double(hash_keys(i, what)); };
    Placement p{part,
                Affine3d::translation({1000 * random(1), 100 * random(2), 500 * random(3)}) *
                    Affine3d::rotation({0, 1, 0}, 6 * random(4)) * Affine3d::scaling(Vec3d(0.5 + random(5))),
                i + 1};
    p.stand_in = 7;
    p.stand_in_below = 10;
    const Bounds3f box = bounds_in_parent(p, placed_bounds(p)).inflated(Vec3f(float(20 * random(6))));
    const auto shared = shared_placement(p, footprint->range({Vec3d(box.lower), Vec3d(box.upper)}));
    if (!shared) continue;
    const ShownPlacement shown = shown_placement(p, footprint);
    EXPECT_EQ(shown.placement.individual, shared->individual);
    EXPECT_EQ(constant_size(shown.footprint.get()), shared->size);
    ++decided;
    stand_ins += shared->individual == p.stand_in;
  }
  EXPECT_GT(decided, 500);
  EXPECT_EQ(stand_ins, decided);
}

TEST(PlacedFootprint, WhatBoundsLeaveOpenIsNotDecided) {
  Placement p{std::make_shared<const Part>(bumpy_model(shapes::cube(), 1, 0)), {}, 5};
  p.stand_in = 7;
  p.stand_in_below = 10;
  EXPECT_TRUE(shared_placement(p, {1.05, 1.1}));
  EXPECT_FALSE(shared_placement(p, {0.9, 1.1})) << "two steps";
  EXPECT_FALSE(shared_placement(p, {0.105, 0.11})) << "seen large";
  EXPECT_FALSE(shared_placement(p, {}));
  p.stand_in = 0;
  EXPECT_FALSE(shared_placement(p, {1.05, 1.1})) << "one of its own";
}

}  // namespace
}  // namespace meristem
