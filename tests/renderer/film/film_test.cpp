#include "renderer/film/film.h"

#include "renderer/film/filter_sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace meristem {
namespace {

class Tent : public Filter {
 public:
  float radius() const override { return 1.5f; }
  float value(float x) const override { return std::max(0.0f, 1.5f - std::abs(x)); }
};

// Catmull and Rom's cubic: 1 at 0, negative between 1 and 2, sums to 1 over the integers.
class CatmullRom : public Filter {
 public:
  float radius() const override { return 2; }
  float value(float x) const override {
    const float d = std::abs(x);
    if (d < 1) return 1.5f * d * d * d - 2.5f * d * d + 1;
    return d < 2 ? -0.5f * d * d * d + 2.5f * d * d - 4 * d + 2 : 0;
  }
};

// The mean of g(x) over the filter, by n samples evenly spread.
template <class G>
double filtered(const FilterSampler& sampler, int n, G g) {
  double sum = 0, weight = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const FilterSample s = sampler.sample({(float(i) + 0.5f) / float(n), (float(j) + 0.5f) / float(n)});
      sum += double(s.weight) * g(s.offset);
      weight += double(s.weight);
    }
  return sum / weight;
}

TEST(FilterSampler, MomentsAreThoseOfTheFilter) {
  // A tent of radius r has the variance r^2 / 6.
  const FilterSampler tent{Tent()};
  EXPECT_NEAR(filtered(tent, 200, [](Vec2f o) { return double(o.x); }), 0, 1e-3);
  EXPECT_NEAR(filtered(tent, 200, [](Vec2f o) { return double(o.x) * double(o.x); }), 1.5 * 1.5 / 6, 1e-3);
  EXPECT_FLOAT_EQ(tent.mean_weight(), 1);
  // Catmull-Rom reproduces quadratics: its second moment is 0.
  const FilterSampler cubic{CatmullRom()};
  EXPECT_NEAR(filtered(cubic, 1000, [](Vec2f o) { return double(o.y) * double(o.y); }), 0, 3e-3);
  // Each lobe has the integral -1/24, so that of |f| is 7/6.
  EXPECT_NEAR(cubic.mean_weight(), 36.0f / 49, 1e-4f);
}

TEST(FilterSampler, StaysInsideTheRadiusAtBothEnds) {
  const FilterSampler cubic{CatmullRom()};
  for (float u : {0.0f, 0x1p-24f, 0.5f, 1 - 0x1p-24f}) {
    const FilterSample s = cubic.sample({u, 1 - 0x1p-24f - u < 0 ? 0 : 1 - 0x1p-24f - u});
    EXPECT_LE(std::abs(s.offset.x), 2.0f);
    EXPECT_LE(std::abs(s.offset.y), 2.0f);
  }
}

TEST(Film, MeansAreThoseOfTheSamples) {
  Film film({0, 0, 2, 1}, 1);
  film.add(0, 0, {.radiance = {1, 2, 3}, .covered = true, .weight = 1});
  film.add(0, 0, {.radiance = {3, 2, 1}, .covered = false, .weight = 1});
  film.add(1, 0, {.radiance = {8, 8, 8}, .covered = true, .weight = 1});
  EXPECT_EQ(film.develop().pixels, (std::vector<float>{2, 2, 2, 0.5f, 8, 8, 8, 1}));
  EXPECT_EQ(film.total_samples(), 3u);
}

TEST(Film, NonFiniteSamplesAreDroppedAndCounted) {
  Film film({0, 0, 1, 1}, 1);
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  film.add(0, 0, {.radiance = {1, 1, 1}, .covered = true, .weight = 1});
  film.add(0, 0, {.radiance = {nan, 1, 1}, .covered = true, .weight = 1});
  film.add(0, 0, {.radiance = {1, 1, inf}, .covered = true, .weight = 1});
  film.add(0, 0, {.radiance = {3, 3, 3}, .covered = true, .weight = 1});
  EXPECT_EQ(film.develop().pixels, (std::vector<float>{2, 2, 2, 1}));
  EXPECT_EQ(film.nonfinite_samples(), 2u);
  EXPECT_EQ(film.total_samples(), 4u);
}

TEST(Film, AConstantImageIsExactWithNegativeWeightsToo) {
  Film film({0, 0, 1, 1}, 0.7f);
  for (int weight : {1, 1, -1, 1, 1})
    film.add(0, 0, {.radiance = {0.3f, 0.3f, 0.3f}, .covered = true, .weight = weight});
  EXPECT_FLOAT_EQ(film.develop().pixels[0], 0.3f);
}

TEST(Film, WeightsThatCancelDoNotBlowUp) {
  Film film({0, 0, 1, 1}, 0.7f);
  film.add(0, 0, {.radiance = {1.0f, 1, 1}, .covered = true, .weight = 1});
  film.add(0, 0, {.radiance = {0.5f, 1, 1}, .covered = true, .weight = -1});
  EXPECT_NEAR(film.develop().pixels[0], 0.5f / 0.7f, 1e-6f);
}

// Each part of a file asks for its own rows; what stands there before does not show.
TEST(Film, RowsAreThoseOfTheWholeImage) {
  const std::vector<Aov> aovs{Aov::Normal, Aov::Z, Aov::Samples};
  Film film({100, 50, 103, 55}, 1, aovs);
  FirstSurface first;
  first.hit.t = 1;
  for (int y = 50; y < 55; ++y)
    for (int x = 100; x < 103; x += 1 + y % 2) {
      const float value = float(10 * y + x);
      first.hit.shading_normal = Vec3f(1 / value);
      film.add(x, y, {.radiance = Spectrum(value), .first = &first, .depth = value});
    }
  const auto expect_rows = [&](const Image& whole, const auto& develop) {
    const std::size_t row = 3 * std::size_t(whole.channels);
    for (const auto& [begin, end] : {std::pair(0, 1), {1, 4}, {4, 5}, {0, 5}}) {
      std::vector<float> rows(std::size_t(end - begin) * row, -1);
      develop(begin, end, rows.data());
      EXPECT_TRUE(std::ranges::equal(rows, std::span(whole.pixels).subspan(std::size_t(begin) * row, rows.size())));
    }
  };
  expect_rows(film.develop(), [&](int begin, int end, float* values) { film.develop(begin, end, values); });
  for (const Aov aov : aovs)
    expect_rows(film.develop(aov), [&](int begin, int end, float* values) { film.develop(aov, begin, end, values); });
}

TEST(Film, AWindowLiesAnywhereInTheFrame) {
  Film film({100, 50, 103, 52}, 1);
  film.add(102, 51, {.radiance = {1, 1, 1}, .covered = true, .weight = 1});
  const Image image = film.develop();
  EXPECT_EQ(image.width, 3);
  EXPECT_EQ(image.height, 2);
  EXPECT_EQ(image.pixels[5 * 4], 1);
  EXPECT_EQ(film.pixels_without_samples(), 5u);
  EXPECT_EQ((PixelWindow{0, 0, 10, 10}.intersected({5, -3, 20, 4})), (PixelWindow{5, 0, 10, 4}));
}

}  // namespace
}  // namespace meristem
