#include "renderer/image/quantizer.h"

#include "tests/renderer/image/scratch_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace meristem {
namespace {

constexpr int side = 256;
const Quantizer rounding(8, {}), dithering(8, {.dither = true});

// Over a square of pixels of one value, given in steps.
struct Spread {
  double mean = 0, variance = 0, variance_of_fours = 0;  // the last: of means over 4 x 4 pixels
  std::set<std::uint32_t> steps;
};
Spread spread(double value, const Quantizer& quantizer = dithering) {
  Spread s;
  for (int y = 0; y < side; y += 4)
    for (int x = 0; x < side; x += 4) {
      double sum = 0;
      for (int i = 0; i < 16; ++i) {
        const std::uint32_t step = quantizer.step(float(value / 255), x + i % 4, y + i / 4, 1);
        s.steps.insert(step);
        sum += step;
        s.variance += std::pow(step - value, 2) / (side * side);
      }
      s.mean += sum / (side * side);
      s.variance_of_fours += std::pow(sum / 16 - value, 2) * 16 / (side * side);
    }
  return s;
}

TEST(Quantizer, DitherKeepsTheMeanOfEveryValue) {
  for (double value : {0.01, 0.1, 0.25, 0.4, 0.49, 0.51, 0.75, 1.0, 1.3, 7.5, 100.0, 100.1, 253.7, 254.4, 254.6, 254.9})
    EXPECT_NEAR(spread(value).mean, value, 0.005) << value;
}

TEST(Quantizer, BlackAndWhiteStayAsTheyAre) {
  EXPECT_EQ(spread(0).steps, std::set<std::uint32_t>{0});
  EXPECT_EQ(spread(-3).steps, std::set<std::uint32_t>{0});
  EXPECT_EQ(spread(std::nan("")).steps, std::set<std::uint32_t>{0});
  EXPECT_EQ(spread(255).steps, std::set<std::uint32_t>{255});
  EXPECT_EQ(spread(HUGE_VAL).steps, std::set<std::uint32_t>{255});
}

// A quarter of a squared step at each pixel, at every value alike: no bands of more and of less noise. White noise
// would leave a sixteenth of it in the mean of 16 pixels; this leaves a third of that.
TEST(Quantizer, NoiseIsEvenAndFine) {
  for (double value : {0.5, 1.0, 20.25, 99.5, 254.0}) {
    const Spread s = spread(value);
    EXPECT_NEAR(s.variance, 0.25, 0.01) << value;
    EXPECT_LT(s.variance_of_fours, 0.4 * 0.25 / 16) << value;
    EXPECT_LE(s.steps.size(), 3u) << value;
  }
}

TEST(Quantizer, ChannelsAreDitheredApart) {
  int alike = 0;
  for (int x = 0; x < 1000; ++x) alike += dithering.step(0.3f, x, 0, 0) == dithering.step(0.3f, x, 0, 2);
  EXPECT_LT(alike, 700);
}

TEST(Quantizer, ACropIsDitheredAsTheWhole) {
  const Quantizer crop(8, {.dither = true, .x0 = 13, .y0 = 7});
  for (int i = 0; i < 1000; ++i)
    EXPECT_EQ(crop.step(0.3f, i % 40, i / 40, 0), dithering.step(0.3f, 13 + i % 40, 7 + i / 40, 0));
}

TEST(Quantizer, WithoutDitherAndInSixteenBitsStepsAreTheNearest) {
  const Quantizer fine(16, {.dither = true});
  for (int i = 0; i <= 1000; ++i) {
    const float value = float(i) / 1000;
    EXPECT_EQ(rounding.step(value, i, 3, 0), std::uint32_t(std::lround(value * 255)));
    EXPECT_EQ(fine.step(value, i, 3, 0), std::uint32_t(value * 65535 + 0.5f));
  }
}

// All files of 8 bits hold the same.
TEST(Quantizer, FilesOfAllFormatsAreDithered) {
  const ScratchFolder folder;
  const Image wall{64, 64, 3, std::vector<float>(64 * 64 * 3, 20.5f / 255)};
  std::vector<float> png;
  for (const char* name : {"a.png", "a.tif", "a.jpg"}) {
    write_image(folder / name, wall, {}, {.dither = true});
    const std::vector<float> read = read_image(folder / name).pixels;
    ASSERT_EQ(read.size(), wall.pixels.size());
    double mean = 0;
    for (const float v : read) mean += double(v) * 255 / double(read.size());
    EXPECT_NEAR(mean, 20.5, 0.1) << name;
    if (std::string(name) == "a.png") png = read;
    if (std::string(name) == "a.tif") {
      EXPECT_EQ(read, png);
    }
  }
}

}  // namespace
}  // namespace meristem
