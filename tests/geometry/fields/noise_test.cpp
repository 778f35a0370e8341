// The noises: their specification in plain C++ (docs/expressions.md), range, smoothness, and statistics without a
// preferred axis.
#include "geometry/fields/noise_constants.h"
#include "tests/geometry/fields/expression_support.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>

namespace meristem {
namespace {

using namespace test;

// The text of docs/expressions.md, in double and one point at a time: lattice points and places of `dimensions`
// numbers.
using Place = std::array<double, 4>;
double reference_gradient(std::uint32_t w, const Place& d) {
  const std::uint32_t h = w * w;
  const std::array<std::uint32_t, 4> windows{h, h << 7, h << 14, h * 0x9e3779b1u};
  double sum = 0;
  for (std::size_t c = 0; c < 4; ++c) sum += double(std::int32_t(windows[c])) * d[c];
  return sum * 0x1p-31;
}
double fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }
using Wrap = std::function<double(std::size_t axis, double lattice)>;
double reference_noise(const Place& p, int dimensions, std::uint32_t seed, const Wrap& wrap) {
  constexpr std::array<std::uint32_t, 4> primes{0xd1342543u, 0xde82ef95u, 0xa24baed5u, 0x9fb21c65u};
  double sum = 0;
  for (int corner = 0; corner < 1 << dimensions; ++corner) {
    double weight = 1;
    Place d{};
    std::uint32_t w = seed;
    for (std::size_t c = 0; c < std::size_t(dimensions); ++c) {
      const double cell = std::floor(p[c]), at = cell + (corner >> c & 1), f = fade(p[c] - cell);
      d[c] = p[c] - at;
      weight *= corner >> c & 1 ? f : 1 - f;
      w ^= std::uint32_t(std::int32_t(wrap(c, at))) * primes[c];
    }
    sum += weight * reference_gradient(w, d);
  }
  return std::clamp(1.25 * sum, -1.0, 1.0);
}
double unwrapped(std::size_t, double lattice) { return lattice; }
double reference_noise(Vec3d p, std::uint32_t seed = 0) {
  return reference_noise({p.x, p.y, p.z, 0}, 3, seed, unwrapped);
}
double reference_noise4(Vec3d p, double t, std::uint32_t seed = 0) {
  return reference_noise({p.x, p.y, p.z, t}, 4, seed, unwrapped);
}

double reference_shift(int k) { return std::fmod((k + 1) * 0.61803398875, 1); }
// Octave k + 1's place of octave k's.
Vec3d reference_octave(Vec3d p, double lacunarity, int k) {
  const Vec3d q = p * lacunarity;
  const double t = (q.y + q.z - q.x) * 2 / 3 + reference_shift(k);
  return {t - q.y, t - q.z, t + q.x};
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

TEST(Noise, OfFourDimensionsFollowsItsSpecification) {
  const Points points(3000, 31, 50);
  const Results r = evaluate("vnoise4(P, x)", points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d p(points.at(i)[3]);
    const double t = points.at(i)[0].x;
    ASSERT_NEAR(r[0][i], reference_noise4(p, t), 4e-6);
    ASSERT_NEAR(r[1][i], reference_noise4(p, t, vector_noise_seed_y), 4e-6);
    ASSERT_NEAR(r[2][i], reference_noise4(p, t, vector_noise_seed_z), 4e-6);
  }
}

TEST(Noise, OfFourDimensionsHasAllItsForms) {
  const Points points(500, 32, 20);
  const auto same = [&](const std::string& a, const std::string& b) {
    const Results r = evaluate(a, points), q = evaluate(b, points);
    EXPECT_EQ(r, q) << a << " and " << b;
  };
  same("snoise(x, y, z, P[0])", "snoise4([x, y, z], P[0])");
  same("snoise(P, x)", "snoise4(P, x)");
  same("noise(P, x)", "0.5*snoise4(P, x) + 0.5");
  same("cnoise(P, x)", "cnoise4(P, x)");
  same("cnoise4(P, x)", "0.5*vnoise4(P, x) + 0.5");
  same("vnoise(P, x)", "vnoise4(P, x)");
  same("snoise4(P, x)", "vnoise4(P, x)[0]");
  same("cfbm4(P, x, 3)", "0.5*vfbm4(P, x, 3) + 0.5");
  same("fbm4(P, x)", "vfbm4(P, x)[0]");
  same("cturbulence(P, 3)", "0.5*vturbulence(P, 3) + 0.5");
  same("vnoise4(P, 0)", "vnoise(P)");
}

TEST(Noise, OfFourDimensionsIsSpreadLikeThatOfThree) {
  const Points points(200000, 33, 300);
  const Results r = evaluate("[snoise4(P, x), snoise(P), 0]", points);
  std::array<double, 2> variance{};
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t c = 0; c < 2; ++c) variance[c] += double(r[c][i]) * r[c][i] / double(points.size());
  EXPECT_NEAR(std::sqrt(variance[0]), 0.24, 0.01);
  EXPECT_NEAR(std::sqrt(variance[1]), 0.24, 0.01);
  const auto [least, most] = std::ranges::minmax(r[0]);
  EXPECT_LT(least, -0.7);
  EXPECT_GT(most, 0.7);
}

// No axis is another's, time included: correlations over the same distance along each.
TEST(Noise, OfFourDimensionsHasNoPreferredAxis) {
  const std::size_t n = 100000;
  Points points(n, 34, 1000);
  const auto values = [](const Points& at) { return evaluate("snoise4(P, x)", at, ValueType::Scalar)[0]; };
  const std::vector<float> here = values(points);
  std::vector<double> correlations;
  for (std::size_t axis = 0; axis < 4; ++axis) {
    Points moved = points;
    for (float& v : axis == 3 ? moved.columns[0][0] : moved.columns[3][axis]) v += 0.4f;
    const std::vector<float> there = values(moved);
    double sum = 0, variance = 0;
    for (std::size_t i = 0; i < n; ++i) {
      sum += double(here[i]) * there[i];
      variance += double(here[i]) * here[i];
    }
    correlations.push_back(sum / variance);
  }
  for (double c : correlations) EXPECT_NEAR(c, correlations[0], 0.02);
}

// `text` reads P, and of four dimensions x as the last.
void expect_not_steeper(const std::string& text, double slope, std::size_t dimensions) {
  const Points points(50000, 25, 20);
  const double h = 1e-3;
  Points moved = points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t axis = i % dimensions;
    (axis == 3 ? moved.columns[0][0] : moved.columns[3][axis])[i] += float(h);
  }
  const Results a = evaluate(text, points, ValueType::Scalar), b = evaluate(text, moved, ValueType::Scalar);
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_LE(std::abs(a[0][i] - b[0][i]), slope * h + 2e-5);
}

TEST(Noise, IsSmoothAcrossCellsAndNotSteeperThanItsBound) {
  expect_not_steeper("snoise(P)", noise_slope, 3);
  expect_not_steeper("pnoise(P, [3, 4, 5])", noise_slope, 3);
  expect_not_steeper("snoise4(P, x)", noise_slope_4d, 4);
  EXPECT_EQ(value("snoise([3, -2, 7])"), 0);
  EXPECT_EQ(value("snoise4([3, -2, 7], 5)"), 0);
}

TEST(Noise, PeriodicOneFollowsItsSpecification) {
  const Points points(3000, 36, 50);
  const Results r = evaluate("[pnoise(P, [3, 7.9, 100]), pnoise(P, [-4, 0, 1e9]), 0]", points);
  const auto wrapped = [](double period) {
    return [period](std::size_t axis, double lattice) {
      const double n = axis == 0 ? 3 : axis == 1 ? 7 : period;
      return lattice - std::floor(lattice / n) * n;
    };
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d p(points.at(i)[3]);
    ASSERT_NEAR(r[0][i], reference_noise({p.x, p.y, p.z, 0}, 3, 0, wrapped(100)), 3e-6);
    ASSERT_NEAR(r[1][i],
                reference_noise({p.x, p.y, p.z, 0}, 3, 0,
                                [](std::size_t axis, double lattice) {
                                  return axis < 2 ? 0 : lattice < 0 ? lattice + 0x1p24 : lattice;
                                }),
                3e-6);
  }
}

TEST(Noise, PeriodicOneComesAgainAndIsElsewhereTheNoise) {
  EXPECT_EQ(value("pnoise([0.25, 1.5, 4.75], [4, 4, 8])"), value("pnoise([4.25, -2.5, 4.75 - 80], [4, 4, 8])"));
  EXPECT_EQ(value("pnoise([2.25, 1.5, 4.75], [4, 4, 8])"), value("snoise([2.25, 1.5, 4.75])"));
  EXPECT_NE(value("pnoise([3.25, 1.5, 4.75], [4, 4, 8])"), value("snoise([3.25, 1.5, 4.75])"));
  // Whole numbers as large as can be, and a quotient that rounding would take to the next period
  EXPECT_EQ(value("pnoise([8388605.5, 0.5, 0.5], [8388607, 9, 9])"),
            value("pnoise([8388605.5 - 8388607, 0.5, 0.5], [8388607, 9, 9])"));
}

TEST(Noise, SumsOctavesAsSpecified) {
  const Points points(500, 22, 3);
  const Results r = evaluate("[fbm(P, 4, 1.7, 0.6), turbulence(P, 3), 0]", points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    double sum = 0, turbulence = 0;
    Vec3d p(points.at(i)[3]), q = p;
    for (int k = 0; k < 4; ++k, p = reference_octave(p, 1.7, k - 1)) sum += std::pow(0.6, k) * reference_noise(p);
    for (int k = 0; k < 3; ++k, q = reference_octave(q, 2, k - 1))
      turbulence += std::pow(0.5, k) * std::abs(reference_noise(q));
    ASSERT_NEAR(r[0][i], sum, 1e-4);
    ASSERT_NEAR(r[1][i], turbulence, 1e-4);
  }
}

TEST(Noise, SumsOctavesOfFourDimensionsAsSpecified) {
  const Points points(500, 37, 3);
  const Results r = evaluate("fbm4(P, x, 4, 1.7, 0.6)", points, ValueType::Scalar);
  for (std::size_t i = 0; i < points.size(); ++i) {
    double sum = 0, time = points.at(i)[0].x;
    Vec3d p(points.at(i)[3]);
    for (int k = 0; k < 4; ++k) {
      sum += std::pow(0.6, k) * reference_noise4(p, time);
      p = reference_octave(p, 1.7, k);
      time = time * 1.7 + reference_shift(k);
    }
    ASSERT_NEAR(r[0][i], sum, 1e-4);
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
