// The noises: their specification in plain C++ (docs/expressions.md), range, smoothness, and statistics without a
// preferred axis.
#include "geometry/fields/noise_constants.h"
#include "tests/geometry/fields/expression_support.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace meristem {
namespace {

using namespace test;

// The text of docs/expressions.md, in double and one point at a time.
double reference_gradient(std::uint32_t w, Vec3d d) {
  const std::uint32_t h = w * w;
  const Vec3d g{double(std::int32_t(h)), double(std::int32_t(h << 7)), double(std::int32_t(h << 14))};
  return dot(g, d) * 0x1p-31;
}
double fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }
double reference_noise(Vec3d p, std::uint32_t seed = 0) {
  const Vec3d cell{std::floor(p.x), std::floor(p.y), std::floor(p.z)};
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d o{double(corner & 1), double(corner >> 1 & 1), double(corner >> 2)}, at = cell + o, d = p - at;
    auto number = [](double v) { return std::uint32_t(std::int32_t(v)); };
    const std::uint32_t w =
        (number(at.x) * 0xd1342543u) ^ (number(at.y) * 0xde82ef95u) ^ (number(at.z) * 0xa24baed5u) ^ seed;
    double weight = 1;
    for (int c = 0; c < 3; ++c) weight *= o[c] > 0 ? fade(p[c] - cell[c]) : 1 - fade(p[c] - cell[c]);
    sum += weight * reference_gradient(w, d);
  }
  return std::clamp(1.25 * sum, -1.0, 1.0);
}

TEST(Noise, FollowsItsSpecification) {
  const Points points(3000, 21, 50);
  const Results r = evaluate("vnoise(P)", points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d p(points.at(i)[3]);
    ASSERT_NEAR(r[0][i], reference_noise(p), 3e-6);
    ASSERT_NEAR(r[1][i], reference_noise(p, vector_noise_seed_y), 3e-6);
    ASSERT_NEAR(r[2][i], reference_noise(p, vector_noise_seed_z), 3e-6);
  }
}

TEST(Noise, SumsOctavesAsSpecified) {
  const Points points(500, 22, 3);
  const Results r = evaluate("[fbm(P, 4, 1.7, 0.6), turbulence(P, 3), 0]", points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    double sum = 0, turbulence = 0;
    Vec3d p(points.at(i)[3]), q = p;
    auto next = [](Vec3d v, double lacunarity, int k) {
      v = v * lacunarity;
      const double t = (v.y + v.z - v.x) * 2 / 3 + std::fmod((k + 1) * 0.61803398875, 1);
      return Vec3d{t - v.y, t - v.z, t + v.x};
    };
    for (int k = 0; k < 4; ++k, p = next(p, 1.7, k - 1)) sum += std::pow(0.6, k) * reference_noise(p);
    for (int k = 0; k < 3; ++k, q = next(q, 2, k - 1)) turbulence += std::pow(0.5, k) * std::abs(reference_noise(q));
    ASSERT_NEAR(r[0][i], sum, 1e-4);
    ASSERT_NEAR(r[1][i], turbulence, 1e-4);
  }
}

TEST(Noise, StaysInItsRangeAndUsesIt) {
  const Points points(200000, 23, 300);
  const Results r = evaluate("[snoise(P), noise(P), turbulence(P)]", points);
  const auto [least, most] = std::ranges::minmax(r[0]);
  EXPECT_GE(least, -1);
  EXPECT_LE(most, 1);
  EXPECT_LT(least, -0.7);
  EXPECT_GT(most, 0.7);
  for (float v : r[1]) ASSERT_TRUE(v >= 0 && v <= 1);
  for (float v : r[2]) ASSERT_GE(v, 0);
}

// Mean 0, and the same correlation along the axes, their negatives and, within the noise of a lattice, the diagonals of
// a plane.
TEST(Noise, HasNoPreferredDirection) {
  const std::size_t n = 100000;
  Points points(n, 24, 1000);
  const Results here = evaluate("snoise(P)", points, ValueType::Scalar);
  double mean = 0, variance = 0;
  for (float v : here[0]) {
    mean += v / double(n);
    variance += double(v) * v / double(n);
  }
  EXPECT_NEAR(mean, 0, 0.006);
  std::vector<double> correlations;
  for (Vec3f d : {Vec3f{0.4f, 0, 0}, Vec3f{0, 0.4f, 0}, Vec3f{0, 0, 0.4f}}) {
    Points moved = points;
    for (std::size_t i = 0; i < n; ++i)
      for (int c = 0; c < 3; ++c) moved.columns[3][std::size_t(c)][i] += d[c];
    const Results there = evaluate("snoise(P)", moved, ValueType::Scalar);
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += double(here[0][i]) * there[0][i] / double(n);
    correlations.push_back(sum / variance);
  }
  EXPECT_NEAR(correlations[0], correlations[1], 0.02);
  EXPECT_NEAR(correlations[0], correlations[2], 0.02);
}

TEST(Noise, IsSmoothAcrossCellsAndNotSteeperThanItsBound) {
  const Points points(50000, 25, 20);
  const double h = 1e-3;
  Points moved = points;
  for (std::size_t i = 0; i < points.size(); ++i) moved.columns[3][i % 3][i] += float(h);
  const Results a = evaluate("snoise(P)", points, ValueType::Scalar),
                b = evaluate("snoise(P)", moved, ValueType::Scalar);
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_LE(std::abs(a[0][i] - b[0][i]), noise_slope * h + 2e-5);
  EXPECT_EQ(value("snoise([3, -2, 7])"), 0);
}

TEST(Noise, CellsAreConstantAndUniform) {
  const Points points(50000, 26, 1000);
  const Results r = evaluate("[cellnoise(P), cellnoise(floor(P) + 0.5), hash(x)]", points);
  std::array<int, 10> cells{}, hashes{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(r[0][i], r[1][i]);
    ++cells[std::size_t(r[0][i] * 10)];
    ++hashes[std::size_t(r[2][i] * 10)];
  }
  for (int count : cells) EXPECT_NEAR(count, 5000, 5 * std::sqrt(4500.0));
  for (int count : hashes) EXPECT_NEAR(count, 5000, 5 * std::sqrt(4500.0));
}

TEST(Voronoi, MeasuresTheDistanceToThePointsItReports) {
  const Points points(5000, 27, 30);
  const Results r = evaluate("[voronoi(P, 1, 0.9), dist(P, pvoronoi(P, 1, 0.9)), voronoi(P, 2, 0.9)]", points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_NEAR(r[0][i], r[1][i], 1e-5);
    ASSERT_LE(r[0][i], r[2][i]);
  }
  EXPECT_NEAR(value("voronoi([0.5, 0.5, 0.5], 1, 0)"), 0, 1e-6);
  EXPECT_NEAR(value("voronoi([1, 1, 1], 1, 0)"), std::sqrt(0.75), 1e-6);
}

}  // namespace
}  // namespace meristem
