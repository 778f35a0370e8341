#include "geometry/base/key.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace meristem {
namespace {

// Chi-square of counts that should all be equal.
double chi_square(const std::vector<int>& counts, double expected) {
  double sum = 0;
  for (int c : counts) sum += (c - expected) * (c - expected) / expected;
  return sum;
}

// Whether a chi-square with many degrees of freedom lies within five standard deviations (sqrt(2 df)) of its mean (df).
void expect_uniform(const std::vector<int>& counts, double expected) {
  const double freedom = double(counts.size()) - 1;
  EXPECT_NEAR(chi_square(counts, expected), freedom, 5 * std::sqrt(2 * freedom));
}

TEST(Key, ScrambleIsTheFinaliserOfSplitMix64) {
  // The generator of Steele, Lea and Flood with seed 0 adds the golden ratio and scrambles; its first outputs are
  // published.
  EXPECT_EQ(scramble(0x9e3779b97f4a7c15ull), 0xe220a8397b1dcdafull);
  EXPECT_EQ(scramble(2 * 0x9e3779b97f4a7c15ull), 0x6e789e6aa1b965f4ull);
}

TEST(Key, EachInputBitFlipsEachOutputBitHalfOfTheTime) {
  constexpr int trials = 2000;
  for (int bit = 0; bit < 64; ++bit) {
    std::vector<int> flips(64, 0);
    for (Key k = 0; k < trials; ++k) {
      const Key difference = hash_keys(k, 7) ^ hash_keys(k ^ (Key(1) << bit), 7);
      for (int out = 0; out < 64; ++out) flips[std::size_t(out)] += int((difference >> out) & 1);
    }
    for (int out = 0; out < 64; ++out)
      EXPECT_NEAR(flips[std::size_t(out)], trials / 2, 6 * std::sqrt(trials / 4.0)) << "bit " << bit << " on " << out;
  }
}

TEST(Key, HashesOfSmallPairsDoNotMeet) {
  std::set<Key> seen;
  for (Key a = 0; a < 300; ++a)
    for (Key b = 0; b < 300; ++b) seen.insert(hash_keys(a, b));
  EXPECT_EQ(seen.size(), 90000u);
}

TEST(Key, OrderMattersButForUnordered) {
  EXPECT_NE(hash_keys(1, 2), hash_keys(2, 1));
  EXPECT_NE(hash_keys(1, 2, 3), hash_keys(1, 3, 2));
  EXPECT_EQ(hash_unordered(1, 2), hash_unordered(2, 1));
  EXPECT_NE(hash_unordered(1, 2), hash_unordered(1, 3));
}

TEST(Key, TextsOfOneLetterDifferenceDiffer) {
  EXPECT_NE(hash_text("angle"), hash_text("anglf"));
  EXPECT_NE(hash_text(""), hash_text("a"));
  EXPECT_EQ(hash_text("angle"), hash_text("angle"));
}

TEST(Uniform, LiesInTheHalfOpenUnitInterval) {
  EXPECT_EQ(uniform_float(0), 0.0f);
  EXPECT_EQ(uniform_double(0), 0.0);
  EXPECT_LT(uniform_float(~Key(0)), 1.0f);
  EXPECT_LT(uniform_double(~Key(0)), 1.0);
}

TEST(Uniform, FillsBinsEvenlyAlongCountingKeys) {
  std::vector<int> counts(256, 0);
  for (Key k = 0; k < 256 * 100; ++k) ++counts[std::size_t(uniform_float(hash_keys(k, 1)) * 256)];
  expect_uniform(counts, 100);
}

TEST(Uniform, FillsSquaresEvenlyForTwoPurposes) {
  std::vector<int> counts(32 * 32, 0);
  for (Key k = 0; k < 32 * 32 * 50; ++k) {
    const auto x = std::size_t(uniform_double(hash_keys(k, 1)) * 32),
               y = std::size_t(uniform_double(hash_keys(k, 2)) * 32);
    ++counts[y * 32 + x];
  }
  expect_uniform(counts, 50);
}

}  // namespace
}  // namespace meristem
