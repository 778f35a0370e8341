#include "renderer/session/sample_sequence.h"

#include "renderer/session/tiles.h"

#include <gtest/gtest.h>

#include <map>

namespace meristem {
namespace {

constexpr PixelWindow window{3, 5, 10, 9};

std::vector<PixelSample> all(SampleSequence& sequence) {
  std::vector<PixelSample> result;
  for (PixelSample s; sequence.next(s);) result.push_back(s);
  return result;
}

TEST(SampleSequence, TakesEverySampleOfEveryPixelOnceAndNoneAheadOfItsTurn) {
  Film film(window, 1);
  SampleSequence sequence(film, tiles_along_hilbert_curve(window, 2), 100);
  std::map<std::pair<int, int>, std::uint32_t> taken;
  for (const std::uint32_t end : {1u, 4u}) {
    sequence.extend(end, {});
    std::uint32_t before = 100;
    for (const PixelSample& s : all(sequence)) {
      std::uint32_t& of_pixel = taken[std::pair(s.x, s.y)];
      EXPECT_EQ(s.number, 100 + of_pixel++);
      EXPECT_GE(s.number, before);
      before = s.number;
    }
    ASSERT_EQ(taken.size(), std::size_t(window.width() * window.height()));
    for (const auto& [pixel, count] : taken) EXPECT_EQ(count, end);
  }
}

TEST(SampleSequence, GoesOnFromAFilmAndLeavesFinishedPixelsOut) {
  Film film(window, 1);
  film.add(4, 6, {.number = 0});
  film.add(4, 6, {.number = 1});
  SampleSequence sequence(film, tiles_along_hilbert_curve(window, 16), 0);
  std::vector<std::uint8_t> finished(std::size_t(window.width() * window.height()));
  finished[0] = 1;
  sequence.extend(3, finished);
  const std::vector<PixelSample> samples = all(sequence);
  EXPECT_EQ(samples.size(), finished.size() * 3 - 3 - 2);
  for (const PixelSample& s : samples) {
    EXPECT_FALSE(s.x == window.x0 && s.y == window.y0);
    EXPECT_TRUE(s.number == 2 || s.x != 4 || s.y != 6);
  }
}

// At any time the film has of each pixel the first samples, and in the end all, with the bits of any other order.
TEST(SampleOrder, SamplesEnterTheFilmInTheirOrder) {
  Film film(window, 1, {Aov::Albedo, Aov::Z}), expected = film;
  SampleOrder order(film, 10);
  const auto sample = [](std::uint32_t i, const FirstSurface& first) {
    return FilmSample{.radiance = Spectrum(float(i)), .number = 10 + i, .first = &first, .depth = float(i)};
  };
  const auto surface = [](std::uint32_t i) {
    FirstSurface first;
    first.hit.t = 1;
    first.albedo = Spectrum(0.1f * float(i));
    return first;
  };
  std::uint32_t added = 0;
  for (const std::uint32_t i : {2u, 1u, 0u, 5u, 3u, 4u}) {
    const FirstSurface first = surface(i);
    added += order.add({4, 6, 10 + i}, sample(i, first));
    EXPECT_EQ(added, film.samples(4, 6));
    EXPECT_EQ(added, i == 0 || i == 5 ? 3u : i == 3 ? 4u : i == 4 ? 6u : 0u);
  }
  for (std::uint32_t i = 0; i < 6; ++i) {
    const FirstSurface first = surface(i);
    expected.add(4, 6, sample(i, first));
  }
  EXPECT_EQ(film.develop().pixels, expected.develop().pixels);
  EXPECT_EQ(film.develop(Aov::Albedo).pixels, expected.develop(Aov::Albedo).pixels);
  EXPECT_EQ(film.develop(Aov::Z).pixels, expected.develop(Aov::Z).pixels);
}

// The last sample of every pixel but those before it: what is kept is some 40 bytes each, and its memory is used again.
TEST(SampleOrder, CountsWhatItKeepsAndUsesItsMemoryAgain) {
  const PixelWindow many{0, 0, 100, 100};
  Film film(many, 1);
  SampleOrder order(film, 0);
  const auto add_to_all = [&](std::uint32_t number) {
    std::uint32_t added = 0;
    for (int y = 0; y < many.y1; ++y)
      for (int x = 0; x < many.x1; ++x) added += order.add({x, y, number}, {.number = number});
    return added;
  };
  constexpr std::uint32_t pixels = 10000;
  EXPECT_EQ(order.bytes(), 0u);
  EXPECT_EQ(add_to_all(3), 0u);
  const std::size_t of_one = order.bytes();
  EXPECT_EQ(add_to_all(2), 0u);
  EXPECT_EQ(add_to_all(1), 0u);
  const std::size_t of_three = order.bytes();
  EXPECT_GT(of_one, pixels * 20u);
  EXPECT_GT(of_three, of_one + 2 * pixels * 20u);
  EXPECT_LT(of_three, 3 * pixels * 48u);
  EXPECT_EQ(add_to_all(0), 4 * pixels);
  for (const std::uint32_t number : {7u, 5u, 6u}) EXPECT_EQ(add_to_all(number), 0u);
  EXPECT_LE(order.bytes(), of_three);
  EXPECT_EQ(add_to_all(4), 4 * pixels);
}

// Samples of a film that wants more of them: surfaces and costs come along.
TEST(SampleOrder, AFilmGetsAllThatItWants) {
  Film film(window, 1, {Aov::Z, Aov::CostTime, Aov::CostExpand});
  SampleOrder order(film, 0);
  FirstSurface first;
  first.hit.t = 1;
  const auto sample = [&](std::uint32_t number) {
    return FilmSample{.number = number,
                      .first = &first,
                      .depth = 5 - float(number),
                      .nanoseconds = 1000000000,
                      .expansions = {.expanded = number + 1}};
  };
  EXPECT_EQ(order.add({4, 6, 1}, sample(1)), 0u);
  EXPECT_EQ(order.add({4, 6, 0}, sample(0)), 2u);
  const std::size_t pixel = std::size_t(6 - window.y0) * std::size_t(window.width()) + std::size_t(4 - window.x0);
  EXPECT_EQ(film.develop(Aov::Z).pixels[pixel], 4);
  EXPECT_EQ(film.develop(Aov::CostTime).pixels[pixel], 2);
  EXPECT_EQ(film.develop(Aov::CostExpand).pixels[pixel], 3);
}

}  // namespace
}  // namespace meristem
