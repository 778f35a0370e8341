#include "renderer/report/image_difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace meristem {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float inf = std::numeric_limits<float>::infinity();

TEST(ImageDifference, OfAnImageAndItselfIsNothing) {
  const Image image{2, 1, 3, {0, 1, 2, 3, 4, -0.0f}};
  const ImageDifference d = image_difference(image, image);
  EXPECT_TRUE(d.identical());
  EXPECT_EQ(d.max, 0);
  EXPECT_EQ(d.rms, 0);
}

TEST(ImageDifference, MeasuresAreThoseOfTheirDefinitions) {
  const Image a{2, 2, 1, {1, 2, 3, 4}}, b{2, 2, 1, {1, 2.5f, 3, 2}};
  const ImageDifference d = image_difference(a, b);
  EXPECT_EQ(d.differing, 2u);
  EXPECT_DOUBLE_EQ(d.max, 2);
  EXPECT_DOUBLE_EQ(d.rms, std::sqrt((0.25 + 4) / 4));
}

TEST(ImageDifference, TheSmallestDifferenceOfFloatsCounts) {
  const Image a{1, 1, 3, {1, 1, 1}}, b{1, 1, 3, {1, std::nextafter(1.0f, 2.0f), 1}};
  EXPECT_FALSE(image_difference(a, b).identical());
  EXPECT_EQ(image_difference(a, b).differing, 1u);
}

TEST(ImageDifference, NaNAndInfinityAreNeverEqualAndDoNotHideTheRest) {
  const Image a{4, 1, 1, {nan, 1, inf, 5}}, b{4, 1, 1, {nan, nan, inf, 2}};
  for (const auto& [x, y] : {std::pair(a, b), std::pair(b, a)}) {
    const ImageDifference d = image_difference(x, y);
    EXPECT_EQ(d.nonfinite, 3u);
    EXPECT_EQ(d.differing, 4u);
    EXPECT_EQ(d.max, 3);
    EXPECT_EQ(d.rms, 3);
  }
  EXPECT_FALSE(image_difference(a, a).identical());
}

TEST(ImageDifference, OfDifferentSizesIsAnError) {
  EXPECT_THROW(image_difference({1, 2, 1, {0, 0}}, {2, 1, 1, {0, 0}}), std::invalid_argument);
}

}  // namespace
}  // namespace meristem
