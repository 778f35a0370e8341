#include "renderer/film/noise.h"

#include "geometry/base/key.h"

#include <gtest/gtest.h>

#include <cmath>

namespace meristem {
namespace {

// Light that is rare and bright: 20 with probability 1/20, so the mean is 1.
float rare_light(int x, int y, std::uint32_t sample, Key seed) {
  return uniform_float(hash_keys(seed, Key(x), Key(y), Key(sample))) < 0.05f ? 20.f : 0.f;
}

// Takes samples as a session does, until all pixels are finished or have `most`. Returns the mean of the pixels.
double adaptive_mean(int side, double limit, std::uint32_t most, Key seed, double& samples_a_pixel) {
  Film film({0, 0, side, side}, 1, {Aov::Variance});
  AdaptiveState state;
  for (std::uint32_t end = noise::first_decision; end <= most; end *= 2) {
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        if (state.finished.empty() || !state.finished[std::size_t(y * side + x)])
          for (std::uint32_t s = film.samples(x, y); s < end; ++s)
            film.add(x, y, {.radiance = Spectrum(rare_light(x, y, s, seed))});
    noise::choose_finished(film, end, limit, state);
  }
  samples_a_pixel = double(film.total_samples()) / (side * side);
  double mean = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) mean += film.statistics(x, y).mean / (side * side);
  return mean;
}

TEST(Noise, AdaptiveSamplingIsNotBiased) {
  const int images = 40, side = 24;
  double sum = 0, squares = 0, samples = 0;
  for (int i = 0; i < images; ++i) {
    double taken = 0;
    const double mean = adaptive_mean(side, 0.3, 1024, hash_keys(5, Key(i)), taken);
    sum += mean;
    squares += mean * mean;
    samples += taken;
  }
  const double mean = sum / images, error = std::sqrt((squares / images - mean * mean) / images);
  EXPECT_NEAR(mean, 1, 4 * error) << "standard error " << error;
  EXPECT_LT(error, 0.01);
  // The variance of a sample is 19: 211 for noise 0.3, that is 256
  EXPECT_GT(samples / images, 128);
  EXPECT_LT(samples / images, 512);
}

// The rule that suggests itself, stopping a pixel by its own samples, fails this test: that it can fail.
TEST(Noise, StoppingAPixelByItsOwnSamplesWouldBeBiased) {
  double sum = 0;
  const int pixels = 20000;
  for (int p = 0; p < pixels; ++p) {
    double total = 0, total_squares = 0;
    std::uint32_t n = 0;
    for (std::uint32_t end = 16; end <= 1024; end *= 2) {
      for (; n < end; ++n) {
        const double light = double(rare_light(p, 0, n, 77));
        total += light, total_squares += light * light;
      }
      const double variance = (total_squares - total * total / n) / (n - 1);
      if (std::sqrt(variance / n) <= 0.3 * (std::sqrt(total / n) + 1e-4)) break;
    }
    sum += total / n;
  }
  EXPECT_LT(sum / pixels, 0.8);
}

TEST(Noise, APixelEndsAsCleanAsAskedFor) {
  Film film({0, 0, 16, 16}, 1, {Aov::Variance});
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x)
      for (std::uint32_t s = 0; s < 64; ++s) {
        const float u = uniform_float(hash_keys(Key(x), Key(y), Key(s)));
        film.add(x, y, {.radiance = Spectrum(4 * u)});  // mean 2, variance 4/3
      }
  const double noise_now = std::sqrt(4.0 / 3 / 64) / std::sqrt(2.0);
  AdaptiveState loose, strict;
  noise::choose_finished(film, 64, noise_now * 1.2, loose);
  noise::choose_finished(film, 64, noise_now / 1.2, strict);
  EXPECT_EQ(std::ranges::count(loose.finished, 1), 256);
  EXPECT_EQ(std::ranges::count(strict.finished, 1), 0);
  EXPECT_EQ(loose.decided_at, 64u);
}

TEST(Noise, ASinglePixelNeverFinishesAndBlackDoes) {
  Film one({0, 0, 1, 1}, 1, {Aov::Variance}), black({0, 0, 4, 4}, 1, {Aov::Variance});
  AdaptiveState of_one, of_black;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) black.add(x, y, {.radiance = {0, 0, 0}});
  one.add(0, 0, {.radiance = {1, 1, 1}});
  noise::choose_finished(one, 16, 0.5, of_one);
  noise::choose_finished(black, 16, 0.01, of_black);
  EXPECT_EQ(of_one.finished, std::vector<std::uint8_t>{0});
  EXPECT_EQ(of_black.finished, std::vector<std::uint8_t>(16, 1));
}

}  // namespace
}  // namespace meristem
