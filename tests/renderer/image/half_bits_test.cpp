#include "renderer/image/half_bits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace meristem {
namespace {

// The value of a half, by its definition.
double value_of(std::uint32_t half) {
  const int exponent = int(half >> 10 & 31);
  const double mantissa = half & 1023;
  return exponent == 0 ? mantissa * 0x1p-24 : (1024 + mantissa) * std::exp2(exponent - 25);
}

TEST(HalfBits, EveryHalfIsItself) {
  for (std::uint32_t half = 0; half < 0x7c00; ++half) {
    EXPECT_EQ(half_bits(float(value_of(half))), half);
    EXPECT_EQ(half_bits(-float(value_of(half))), half | 0x8000u);
  }
}

TEST(HalfBits, TheNearestIsTakenAndOfTwoTheEvenOne) {
  for (std::uint32_t half = 0; half + 1 < 0x7c00; ++half) {
    const float middle = float((value_of(half) + value_of(half + 1)) / 2);
    EXPECT_EQ(half_bits(middle), half + (half & 1)) << middle;
    EXPECT_EQ(half_bits(std::nextafter(middle, 0.0f)), half);
    EXPECT_EQ(half_bits(std::nextafter(middle, 1e6f)), half + 1);
  }
}

TEST(HalfBits, BeyondTheirRange) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(half_bits(65519.99f), 0x7bff);
  EXPECT_EQ(half_bits(65520), 0x7c00);
  EXPECT_EQ(half_bits(-infinity), 0xfc00);
  EXPECT_EQ(half_bits(1e-30f), 0);
  const std::uint16_t nan = half_bits(std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE((nan & 0x7c00) == 0x7c00 && (nan & 0x3ff) != 0);
}

}  // namespace
}  // namespace meristem
