// Media against what can be calculated: Beer's law, quadrature, and the phase function's integral.
#include "renderer/language/jsonc_reader.h"
#include "renderer/media/expression_medium.h"
#include "renderer/media/phase.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>

namespace meristem {
namespace {

std::unique_ptr<ExpressionMedium> medium(const std::string& text) {
  Diagnostics diagnostics;
  const Value value = read_jsonc(std::make_shared<SourceText>(SourceText{"test", text}), diagnostics);
  Params params(value, "medium", diagnostics);
  auto made = std::make_unique<ExpressionMedium>(params);
  params.finish();
  diagnostics.throw_if_errors();
  made->fill({});
  return made;
}

Ray ray_along_x(float from, float to, float y = 0.3f) {
  Ray ray;
  ray.origin = {from, y, 0.2f};
  ray.direction = {1, 0, 0};
  ray.t_max = to - from;
  return ray;
}

struct Estimate {
  double mean = 0, error = 0;  // standard error of the mean
};

Estimate estimate(const std::function<double(RandomStream&)>& draw, int samples = 40000) {
  double sum = 0, squares = 0;
  for (int i = 0; i < samples; ++i) {
    RandomStream random(uniform_float(hash_keys(7, Key(i))));
    const double x = draw(random);
    sum += x, squares += x * x;
  }
  const double mean = sum / samples;
  return {mean, std::sqrt(std::max(squares / samples - mean * mean, 0.0) / samples)};
}

// Both estimators: what passes, and how often there is no collision.
void expect_passed(const ExpressionMedium& m, const Ray& ray, double expected) {
  const Estimate ratio = estimate([&](RandomStream& r) { return double(m.transmittance(ray, r)); });
  EXPECT_NEAR(ratio.mean, expected, 4.5 * ratio.error + 1e-6);
  const Estimate flights = estimate([&](RandomStream& r) {
    MediumCollision c;
    return m.collide(ray, r, c) ? 0.0 : 1.0;
  });
  EXPECT_NEAR(flights.mean, expected, 4.5 * flights.error + 1e-6);
}

TEST(Medium, EvenMatterDimsByBeersLaw) {
  const auto m = medium(R"({ "density": 0.7, "from": [0, 0, 0], "to": [3, 1, 1] })");
  expect_passed(*m, ray_along_x(-5, 10), std::exp(-0.7 * 3));
  expect_passed(*m, ray_along_x(1, 2.5f), std::exp(-0.7 * 1.5));
  expect_passed(*m, ray_along_x(-5, 0.5f), std::exp(-0.7 * 0.5));
  expect_passed(*m, ray_along_x(-5, 10, 1.5f), 1);  // beside the box
  expect_passed(*m, ray_along_x(4, 10), 1);         // behind it
}

TEST(Medium, UnevenMatterDimsByTheIntegralOfItsDensity) {
  const auto m = medium(
      R"x({ "density": "2*smoothstep(fbm(2*P), -.2, .4)*(P[0] < 4.5)", "from": [-1, -1, -1], "to": [6, 2, 1] })x");
  Symbols symbols;
  symbols.add("P", ValueType::Vector);
  const auto density = Expression::compile("2*smoothstep(fbm(2*P), -.2, .4)*(P[0] < 4.5)", symbols, ValueType::Scalar);
  constexpr int steps = 20000;
  double depth = 0;
  for (int i = 0; i < steps; ++i) {
    const std::array<Vec3f, 1> place{Vec3f{float(-1 + 7 * (i + 0.5) / steps), 0.3f, 0.2f}};
    depth += double(density->evaluate_scalar(place)) * 7 / steps;
  }
  ASSERT_GT(depth, 0.5);
  expect_passed(*m, ray_along_x(-3, 8), std::exp(-depth));
  Ray back = ray_along_x(8, 8);
  back.direction = {-1, 0, 0};
  back.t_max = 11;
  expect_passed(*m, back, std::exp(-depth));
}

TEST(Medium, CollidesWhereItsMatterIs) {
  const auto m = medium(
      R"x({ "density": "5*(P[0] > 2 && P[0] < 2.5)", "albedo": [0.5, 2, -1], "emission": "P",
             "from": [0, 0, 0], "to": [4, 1, 1] })x");
  for (int i = 0; i < 2000; ++i) {
    RandomStream random(uniform_float(hash_keys(3, Key(i))));
    MediumCollision c;
    if (!m->collide(ray_along_x(-1, 9), random, c)) continue;
    ASSERT_GE(c.t, 3);
    ASSERT_LE(c.t, 3.5);
    ASSERT_EQ(c.albedo, Spectrum(0.5f, 1, 0));
    ASSERT_NEAR(c.emission.x, c.t - 1, 1e-5);
  }
}

TEST(Medium, IsTheSameForEqualNumbersAndSlantedRays) {
  const auto m = medium(R"x({ "density": "turbulence(3*P)", "from": [-1, -1, -1], "to": [1, 1, 1] })x");
  Ray ray;
  ray.origin = {-2, -1.9f, -2.2f};
  ray.direction = normalize(Vec3f{1, 1, 1.1f});
  for (int i = 0; i < 100; ++i) {
    RandomStream a(uniform_float(Key(i) << 40)), b(uniform_float(Key(i) << 40));
    EXPECT_EQ(m->transmittance(ray, a), m->transmittance(ray, b));
  }
}

TEST(Medium, RefusesWhatHasNoBound) {
  const auto error = [](const std::string& text) {
    try {
      medium(text);
    } catch (const std::runtime_error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(error(R"({ "density": "1/P[0]", "from": [0, 0, 0], "to": [1, 1, 1] })").find("the limit is 10000"),
            std::string::npos);
  EXPECT_NE(error(R"({ "density": 1 })").find("needs objects"), std::string::npos);
  EXPECT_NE(error(R"({ "from": [0, 0, 0] })").find("two corners"), std::string::npos);
  EXPECT_NE(error(R"({ "from": [0, 0, 0], "to": [1, 0, 1] })").find("two corners"), std::string::npos);
}

// The integral of the phase function over all directions whose cosine is less.
double share_below(double g, double cosine) {
  if (g == 0) return (cosine + 1) / 2;
  return (1 - g * g) / (2 * g) * (1 / std::sqrt(1 + g * g - 2 * g * cosine) - 1 / (1 + g));
}

TEST(Phase, IntegratesToOneAndIsSampledByItself) {
  for (const float g : {-0.9f, -0.3f, 0.0f, 0.5f, 0.95f}) {
    constexpr int steps = 20000;
    double sum = 0, mean = 0;
    for (int i = 0; i < steps; ++i) {
      const double cosine = -1 + 2 * (i + 0.5) / steps;
      const double share = double(phase(g, float(cosine))) * 2 * pi * 2 / steps;
      sum += share, mean += share * cosine;
    }
    EXPECT_NEAR(sum, 1, 2e-3) << g;
    EXPECT_NEAR(mean, double(g), 2e-3) << g;
    const Vec3f axis = normalize(Vec3f{0.3f, -0.8f, 0.5f});
    constexpr int samples = 40000, bins = 8;
    std::array<int, bins> counts{};
    for (int i = 0; i < samples; ++i) {
      const Vec3f w = sample_phase(g, axis, {(float(i) + 0.5f) / samples, uniform_float(scramble(Key(i)))});
      ASSERT_NEAR(length(w), 1, 1e-5);
      ++counts[std::size_t(std::clamp(int((dot(w, axis) + 1) / 2 * bins), 0, bins - 1))];
    }
    for (int b = 0; b < bins; ++b) {
      const double expected = share_below(g, -1 + 2.0 * (b + 1) / bins) - share_below(g, -1 + 2.0 * b / bins);
      EXPECT_NEAR(double(counts[std::size_t(b)]) / samples, expected, 4e-3) << g << ' ' << b;
    }
  }
}

}  // namespace
}  // namespace meristem
