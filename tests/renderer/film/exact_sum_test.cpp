#include "renderer/film/exact_sum.h"

#include "geometry/base/key.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace meristem {
namespace {

// Floats of both signs over sixty powers of two.
std::vector<float> wild_numbers(int count) {
  std::vector<float> numbers;
  for (int i = 0; i < count; ++i) {
    const Key key = hash_keys(1, Key(i));
    const int exponent = int(key % 60) - 30;
    numbers.push_back(std::ldexp(2 * uniform_float(scramble(key)) - 1, exponent));
  }
  return numbers;
}

double sum_of(const std::vector<float>& numbers) {
  ExactSum sum;
  for (const float x : numbers) sum.add(double(x));
  return sum.value();
}

TEST(ExactSum, DoesNotDependOnOrderOrGroups) {
  std::vector<float> numbers = wild_numbers(1000);
  const double expected = sum_of(numbers);
  std::ranges::sort(numbers);
  EXPECT_EQ(sum_of(numbers), expected);
  std::ranges::reverse(numbers);
  EXPECT_EQ(sum_of(numbers), expected);
  ExactSum whole;
  for (std::size_t begin = 0, size = 1; begin < numbers.size(); begin += size++) {
    ExactSum part;
    for (std::size_t i = begin; i < std::min(begin + size, numbers.size()); ++i) part.add(double(numbers[i]));
    whole.add(part);
  }
  EXPECT_EQ(whole.value(), expected);
}

TEST(ExactSum, IsTheSum) {
  const std::vector<float> numbers = wild_numbers(1000);
  long double expected = 0;
  for (const float x : numbers) expected += static_cast<long double>(x);
  EXPECT_NEAR(sum_of(numbers), double(expected), 1e-6);
  // What cancels is gone, what is small stays
  EXPECT_EQ(sum_of({1e12f, 1e-9f, -1e12f}), double(1e-9f));
  EXPECT_EQ(sum_of({-0.25f, -0.5f}), -0.75);
  EXPECT_EQ(sum_of({}), 0);
}

TEST(ExactSum, CutsOffWhatLiesBelowItsUnit) {
  for (const double sign : {1.0, -1.0}) {
    ExactSum sum;
    for (const double x : {0x1p-64, 0x1.8p-63, 0x1.fp-65, 0x1p-1074, 0.0}) sum.add(sign * x);
    EXPECT_EQ(sum.value(), sign * 0x1p-62);
    sum.add(sign * 0x1.fffffffffffffp41);
    sum.add(sign * -0x1.fffffffffffffp41);
    EXPECT_EQ(sum.value(), sign * 0x1p-62);
  }
}

TEST(ExactSum, HoldsAMillionOfTheLargestTerms) {
  ExactSum sum, part;
  for (int i = 0; i < 1024; ++i) part.add(-0x1.fffffep41);
  for (int i = 0; i < 1024; ++i) sum.add(part);
  EXPECT_EQ(sum.value(), -0x1.fffffep41 * 0x1p20);
}

}  // namespace
}  // namespace meristem
