// Interpolation, background and bounds of grids in memory.
#include "geometry/volumes/brick_grid.h"

#include "geometry/base/key.h"
#include "tests/geometry/volumes/function_voxels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace meristem {
namespace {

using test::FunctionVoxels;

float random_sample(int x, int y, int z) {
  return uniform_float(hash_keys(Key(x + 1000), Key(y + 1000), Key(z + 1000)));
}

// Turned, stretched and moved, with samples on both sides of the origin and over several bricks.
FunctionVoxels random_voxels() {
  FunctionVoxels v({-11, -3, 5}, {14, 9, 30}, random_sample);
  v.background = -2;
  v.world_from_index =
      Affine3d::translation({1, 2, 3}) * Affine3d::rotation({0, 1, 0}, 0.4) * Affine3d::scaling({0.5, 0.5, 0.25});
  return v;
}

Vec3d random_index(std::mt19937& random, double beyond) {
  auto in = [&](double a, double b) { return std::uniform_real_distribution<double>(a - beyond, b + beyond)(random); };
  return {in(-11, 14), in(-3, 9), in(5, 30)};
}

TEST(BrickGrid, InterpolatesBetweenTheEightSamplesAround) {
  const FunctionVoxels voxels = random_voxels();
  const BrickGrid grid(voxels);
  const Affine3d to_index = voxels.world_from_index.inverse();
  std::mt19937 random(1);
  for (int i = 0; i < 20000; ++i) {
    const Vec3f place(voxels.world_from_index.point(random_index(random, 3)));
    const Vec3d p = to_index.point(Vec3d(place));
    double expected = 0;
    for (int corner = 0; corner < 8; ++corner) {
      double weight = 1;
      std::array<int, 3> at{};
      for (int c = 0; c < 3; ++c) {
        const double first = std::floor(p[c]), t = p[c] - first;
        at[std::size_t(c)] = int(first) + (corner >> c & 1);
        weight *= corner >> c & 1 ? t : 1 - t;
      }
      expected += weight * double(voxels.at(at[0], at[1], at[2]));
    }
    ASSERT_NEAR(grid.value(place), expected, 3e-6) << p.x << ' ' << p.y << ' ' << p.z;
  }
}

TEST(BrickGrid, HasTheGradientOfALinearField) {
  FunctionVoxels voxels({-20, -20, -20}, {20, 20, 20}, [](int x, int y, int z) { return float(2 * x - y + 3 * z); });
  voxels.world_from_index = Affine3d::scaling(Vec3d(0.5));
  const Vec3f g = BrickGrid(voxels).gradient({1.3f, -2.1f, 0.7f});
  EXPECT_NEAR(g.x, 4, 1e-4);
  EXPECT_NEAR(g.y, -2, 1e-4);
  EXPECT_NEAR(g.z, 6, 1e-4);
}

TEST(BrickGrid, BoundsHoldEveryValueAndGradientOfABox) {
  const FunctionVoxels voxels = random_voxels();
  const BrickGrid grid(voxels);
  std::mt19937 random(2);
  auto unit = [&] { return std::uniform_real_distribution<double>(0, 1)(random); };
  for (int i = 0; i < 600; ++i) {
    const Vec3d center = voxels.world_from_index.point(random_index(random, 3));
    const double size = std::pow(10.0, -4 + 5 * unit());
    const Bounds3d box{center - Vec3d(size * unit(), size * unit(), size * unit()), center + Vec3d(size * unit())};
    const Interval value = grid.value_bounds(box), slope = grid.gradient_bounds(box);
    for (int k = 0; k < 60; ++k) {
      auto between = [&](int c) {
        return std::clamp(float(box.lower[c] + unit() * (box.upper[c] - box.lower[c])),
                          std::nextafterf(float(box.lower[c]), INFINITY), float(box.upper[c]));
      };
      const Vec3f place{between(0), between(1), between(2)};
      if (!box.contains(Vec3d(place))) continue;
      const float v = grid.value(place);
      ASSERT_TRUE(v >= value.lower && v <= value.upper) << v << " in " << value.lower << ", " << value.upper;
      const Vec3f g = grid.gradient(place);
      for (int c = 0; c < 3; ++c) ASSERT_TRUE(g[c] >= slope.lower && g[c] <= slope.upper);
    }
  }
}

TEST(BrickGrid, BoundsAreSharpWhereTheBoxIsSmallAndExactFarAway) {
  FunctionVoxels voxels({0, 0, 0}, {63, 63, 63}, [](int x, int, int) { return float(x); });
  const BrickGrid grid(voxels);
  const Interval small = grid.value_bounds({{10.2, 30, 30}, {10.8, 30.5, 30.5}});
  EXPECT_NEAR(small.lower, 10, 1e-3);
  EXPECT_NEAR(small.upper, 11, 1e-3);
  const Interval large = grid.value_bounds({{16.5, 1, 1}, {31.5, 30, 30}});  // by whole bricks
  EXPECT_GE(large.lower, 7);
  EXPECT_LE(large.upper, 41);
  const Interval away = grid.value_bounds({{100, 0, 0}, {110, 1, 1}});
  EXPECT_EQ(away.lower, 0);
  EXPECT_EQ(away.upper, 0);
}

TEST(BrickGrid, WithoutSamplesIsItsBackground) {
  FunctionVoxels none({0, 0, 0}, {-1, -1, -1}, random_sample);
  none.background = 3;
  const BrickGrid grid(none);
  EXPECT_EQ(grid.value({1, 2, 3}), 3);
  EXPECT_TRUE(grid.bounds().empty());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(BrickGrid(random_voxels()).value({nan, 0, 0}), -2);
}

TEST(BrickGrid, RefusesWhatIsTooLargeOrNotFinite) {
  EXPECT_THROW(BrickGrid(FunctionVoxels({0, 0, 0}, {1 << 20, 1 << 20, 0}, random_sample)), std::runtime_error);
  EXPECT_THROW(BrickGrid(FunctionVoxels({-(1 << 30) - 1, 0, 0}, {0, 0, 0}, random_sample)), std::runtime_error);
  EXPECT_THROW(BrickGrid(FunctionVoxels({0, 0, 0}, {1, 1, 1}, [](int, int, int) { return std::nanf(""); })),
               std::runtime_error);
}

}  // namespace
}  // namespace meristem
