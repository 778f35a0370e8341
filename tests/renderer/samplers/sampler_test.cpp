#include "tests/support/component.h"

#include <gtest/gtest.h>

#include <set>

namespace meristem {
void register_independent(SamplerRegistry& r);
void register_sobol(SamplerRegistry& r);

namespace {

// The 2D points of one request of a pixel: skips `before` requests first.
std::vector<Vec2f> points(Sampler& sampler, int count, int before, int pixel_x = 3, std::uint64_t seed = 0) {
  std::vector<Vec2f> result;
  for (int i = 0; i < count; ++i) {
    sampler.start(pixel_x, 5, i, seed);
    for (int k = 0; k < before; ++k) sampler.next_1d();
    result.push_back(sampler.next_2d());
  }
  return result;
}

TEST(Sobol, EveryElementaryIntervalHoldsOneSample) {
  const auto sampler = make<Sampler>(register_sobol);
  for (int log_count = 0; log_count <= 10; ++log_count)
    for (int request : {0, 1, 7}) {
      const int count = 1 << log_count;
      const auto p = points(*sampler, count, request);
      for (int columns = 1; columns <= count; columns *= 2) {
        std::set<int> cells;
        for (const Vec2f v : p)
          cells.insert(int(v.x * float(columns)) * (count / columns) + int(v.y * float(count / columns)));
        EXPECT_EQ(cells.size(), std::size_t(count)) << count << " samples, " << columns << " columns";
      }
    }
}

TEST(Sobol, OneDimensionIsStratifiedToo) {
  const auto sampler = make<Sampler>(register_sobol);
  for (int request = 0; request < 4; ++request) {
    std::set<int> cells;
    for (int i = 0; i < 256; ++i) {
      sampler->start(1, 2, i, 9);
      for (int k = 0; k < request; ++k) sampler->next_2d();
      cells.insert(int(sampler->next_1d() * 256));
    }
    EXPECT_EQ(cells.size(), 256u);
  }
}

// Padding must not correlate requests: in a 16 x 16 grid of (request a, request b), chi-square with 255 degrees of
// freedom.
TEST(Sobol, RequestsAreIndependentOfEachOther) {
  const auto sampler = make<Sampler>(register_sobol);
  constexpr int side = 16, count = 1 << 14;
  std::vector<int> cells(side * side);
  for (int i = 0; i < count; ++i) {
    sampler->start(0, 0, i, 1);
    const Vec2f a = sampler->next_2d(), b = sampler->next_2d();
    ++cells[std::size_t(int(a.x * side) * side + int(b.x * side))];
  }
  double chi2 = 0;
  const double expected = double(count) / (side * side);
  for (int n : cells) chi2 += (n - expected) * (n - expected) / expected;
  EXPECT_LT(chi2, 255 + 5 * std::sqrt(2 * 255.0));
}

class AnySampler : public testing::TestWithParam<void (*)(SamplerRegistry&)> {
 protected:
  std::unique_ptr<Sampler> sampler = make<Sampler>(GetParam());
};
INSTANTIATE_TEST_SUITE_P(, AnySampler, testing::Values(&register_sobol, &register_independent),
                         [](const auto& test) { return test.index == 0 ? "sobol" : "independent"; });

TEST_P(AnySampler, SkipsNumbersThatNobodyWants) {
  sampler->start(3, 5, 7, 0);
  sampler->next_2d();
  const float next = sampler->next_1d();
  sampler->start(3, 5, 7, 0);
  sampler->skip_2d();
  EXPECT_EQ(sampler->next_1d(), next);
}

// The bits of Burley's definition, written as it is: films that are gone on with depend on them.
TEST(Sobol, HasTheBitsOfItsDefinition) {
  const auto reversed = [](std::uint32_t x) {
    std::uint32_t r = 0;
    for (int i = 0; i < 32; ++i) r |= (x >> i & 1) << (31 - i);
    return r;
  };
  const auto scrambled = [&](std::uint32_t x, std::uint32_t seed) {
    x = reversed(x) + seed;
    for (const std::uint32_t factor : {0x6c50b47cu, 0xb82f1e52u, 0xc7afe638u, 0x8d22f6e6u}) x ^= x * factor;
    return reversed(x);
  };
  const auto unit = [](std::uint32_t x) { return float(x >> 8) * 0x1p-24f; };
  const auto sampler = make<Sampler>(register_sobol);
  for (int i = 0; i < 100; ++i) {
    sampler->start(i % 3, i % 5, i, 2);
    const Key pixel = hash_keys(2, Key(i % 3), Key(i % 5)), first = hash_keys(pixel, 0), second = hash_keys(pixel, 1);
    EXPECT_EQ(sampler->next_1d(),
              unit(scrambled(reversed(scrambled(std::uint32_t(i), std::uint32_t(first))), std::uint32_t(first >> 32))));
    EXPECT_EQ(sampler->next_2d().x, unit(scrambled(reversed(scrambled(std::uint32_t(i), std::uint32_t(second))),
                                                   std::uint32_t(second >> 32))));
  }
}

TEST_P(AnySampler, IsUniformOverPixels) {
  constexpr int side = 16, pixels = 128 * 128;
  std::vector<int> cells(side * side);
  for (int i = 0; i < pixels; ++i) {
    sampler->start(i % 128, i / 128, 0, 42);
    const Vec2f p = sampler->next_2d();
    ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
    ++cells[std::size_t(int(p.x * side) * side + int(p.y * side))];
  }
  double chi2 = 0;
  const double expected = double(pixels) / (side * side);
  for (int n : cells) chi2 += (n - expected) * (n - expected) / expected;
  EXPECT_LT(chi2, 255 + 5 * std::sqrt(2 * 255.0));
}

TEST_P(AnySampler, DependsOnPixelSampleDimensionAndSeedAlone) {
  const auto first = points(*sampler, 8, 2);
  const auto clone = sampler->clone();
  EXPECT_EQ(points(*clone, 8, 2), first);
  EXPECT_NE(points(*sampler, 8, 3), first);
  EXPECT_NE(points(*sampler, 8, 2, 4), first);
  EXPECT_NE(points(*sampler, 8, 2, 3, 1), first);
}

}  // namespace
}  // namespace meristem
