#include "renderer/report/flip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace meristem {
namespace {

Image plain(float r, float g, float b, int side = 24) {
  Image image{side, side, 3, {}};
  for (int i = 0; i < side * side; ++i) image.pixels.insert(image.pixels.end(), {r, g, b});
  return image;
}

TEST(Flip, OfAnImageAndItselfIsNothing) {
  Image image = plain(0.2f, 0.4f, 0.9f);
  image.pixels[100] = 1;
  EXPECT_EQ(mean_value(flip(image, image)), 0);
}

// The paper scales colour distances so that this pair is the largest of all, section 4.1.2.
TEST(Flip, FromGreenToBlueIsOne) {
  const Image difference = flip(plain(0, 1, 0), plain(0, 0, 1));
  for (const float v : difference.pixels) EXPECT_NEAR(v, 1, 1e-4);
}

// By hand from the formulas: black is (0, 0, 0) and white (100, 0, 0) in L*a*b*, so their distance is 100; green is
// (87.735, -75.6, 73.0) and blue (32.297, 25.6, -34.8) after the Hunt adjustment, a distance of 203.3. With the
// exponent 0.7 that is 25.119 of 41.24; beyond 0.4 of the latter: 0.95 + 0.05 * (25.119 - 16.50) / (41.24 - 16.50).
TEST(Flip, FromBlackToWhite) { EXPECT_NEAR(mean_value(flip(plain(0, 0, 0), plain(1, 1, 1))), 0.9674, 2e-3); }

TEST(Flip, GrowsWithTheDifferenceAndWithItsSize) {
  const Image grey = plain(0.5f, 0.5f, 0.5f);
  double last = 0;
  for (const float v : {0.51f, 0.55f, 0.6f, 0.8f}) {
    const double error = mean_value(flip(grey, plain(v, v, v)));
    EXPECT_GT(error, last);
    last = error;
  }
  Image dot = grey, square = grey;
  const auto paint = [](Image& image, int x, int y) {
    for (int c = 0; c < 3; ++c) image.pixels[std::size_t((y * image.width + x) * 3 + c)] = 1;
  };
  paint(dot, 12, 12);
  for (int y = 8; y < 16; ++y)
    for (int x = 8; x < 16; ++x) paint(square, x, y);
  EXPECT_GT(mean_value(flip(grey, dot)), 0);
  EXPECT_GT(mean_value(flip(grey, square)), 4 * mean_value(flip(grey, dot)));
}

TEST(Flip, FinePatternsVanishFromAfarButNotFromNear) {
  Image checks = plain(0, 0, 0, 32);
  for (std::size_t i = 0; i < checks.pixels.size(); ++i) checks.pixels[i] = float((i / 3 % 32 + i / 3 / 32) % 2);
  // The grey with the mean light of black and white
  const Image grey = plain(0.7354f, 0.7354f, 0.7354f, 32);
  const auto middle = [](const Image& image) { return double(image.pixels[16 * 32 + 16]); };
  EXPECT_LT(middle(flip(checks, grey, {120})), middle(flip(checks, grey, {10})) / 2);
}

TEST(Flip, NotANumberCountsAsBlackAndSizesMustAgree) {
  Image broken = plain(0, 0, 0);
  broken.pixels[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(mean_value(flip(broken, plain(0, 0, 0))), 0);
  EXPECT_THROW(flip(plain(0, 0, 0, 8), plain(0, 0, 0, 9)), std::invalid_argument);
}

}  // namespace
}  // namespace meristem
