// What a film knows beside the picture.
#include "renderer/film/film.h"
#include "renderer/film/film_parts.h"

#include "geometry/base/key.h"
#include "tests/renderer/image/part_values.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

namespace meristem {
namespace {

FirstSurface surface(float x, int object, int material) {
  FirstSurface first;
  first.hit.t = 1;
  first.hit.position = {x, 2, 3};
  first.hit.shading_normal = {0, 0, 1};
  first.hit.u = x / 2;
  first.hit.object = object;
  first.albedo = {0.5f, 0.25f, x};
  first.material = material;
  return first;
}

// `count` samples of one pixel, from `begin` on: light, surfaces, depths and weights all vary.
void add_samples(Film& film, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    const Key key = hash_keys(3, Key(i));
    const float x = uniform_float(key);
    const FirstSurface first = surface(x, int(key % 3), int(key % 2));
    const bool met = key % 5 != 0;
    film.add(0, 0,
             {.radiance = {x, 1 / (x + 0.1f), x * x},
              .covered = met,
              .weight = key % 7 == 0 ? -1 : 1,
              .number = std::uint32_t(i),
              .first = met ? &first : nullptr,
              .depth = 1 + std::floor(4 * x)});
  }
}

const SceneNames names{{"oak", "ash", "elm"}, {"default", "bark"}, {}};

TEST(FilmAovs, AFilmMergedInAnyOrderHasTheBitsOfTheWhole) {
  const std::vector<Aov> aovs = parse_aovs("all");
  Film whole({0, 0, 1, 1}, 1, aovs), a = whole, b = whole, c = whole;
  add_samples(whole, 0, 100);
  add_samples(a, 0, 13);
  add_samples(b, 13, 64);
  add_samples(c, 64, 100);
  c.merge(a);
  c.merge(b);
  const auto expected = film_parts(whole, names, false), found = film_parts(c, names, false);
  ASSERT_EQ(found.size(), 1 + aovs.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_EQ(values_of(found[i]), values_of(expected[i])) << found[i].name;
}

TEST(FilmAovs, MeansAndTheNearest) {
  Film film({4, 4, 5, 5}, 1, parse_aovs("albedo,normal,Z,P,uv,motion,id.object,id.material,samples"));
  const FirstSurface far = surface(0.25f, 0, 1), near = surface(0.75f, 1, 0);
  film.add(4, 4, {.radiance = {1, 1, 1}, .number = 0, .first = &far, .depth = 9});
  film.add(4, 4, {.radiance = {1, 1, 1}, .number = 1, .first = &near, .depth = 2, .motion = {4, -5}});
  film.add(4, 4, {.radiance = {1, 1, 1}, .number = 2, .first = &far, .depth = 7});
  film.add(4, 4, {.radiance = {0, 0, 0}, .covered = false, .number = 3});
  EXPECT_EQ(film.develop(Aov::Albedo).pixels, (std::vector<float>{0.375f, 0.1875f, 1.25f / 4}));
  EXPECT_EQ(film.develop(Aov::Normal).pixels, (std::vector<float>{0, 0, 0.75f}));
  EXPECT_EQ(film.develop(Aov::Z).pixels, (std::vector<float>{2}));
  EXPECT_EQ(film.develop(Aov::P).pixels, (std::vector<float>{0.75f, 2, 3}));
  EXPECT_EQ(film.develop(Aov::Uv).pixels, (std::vector<float>{0.375f, 0}));
  EXPECT_EQ(film.develop(Aov::Motion).pixels, (std::vector<float>{4, -5}));
  EXPECT_EQ(film.develop(Aov::ObjectId).pixels, (std::vector<float>{2}));
  EXPECT_EQ(film.develop(Aov::MaterialId).pixels, (std::vector<float>{1}));
  EXPECT_EQ(film.develop(Aov::Samples).pixels, (std::vector<float>{4}));
}

TEST(FilmAovs, APixelThatShowsNothingIsFarAwayAndOfNoObject) {
  Film film({0, 0, 2, 1}, 1, parse_aovs("Z,id.object"));
  film.add(0, 0, {.radiance = {1, 1, 1}, .covered = false});
  EXPECT_EQ(film.develop(Aov::Z).pixels, (std::vector<float>{1e10f, 0}));  // the second has no samples
  EXPECT_EQ(film.develop(Aov::ObjectId).pixels, (std::vector<float>{0, 0}));
}

TEST(FilmAovs, VarianceIsThatOfTheMeanLuminance) {
  Film film({0, 0, 2, 1}, 1, {Aov::Variance});
  std::vector<double> light;
  for (int i = 0; i < 50; ++i) {
    const float x = 3 * uniform_float(hash_keys(9, Key(i)));
    film.add(0, 0, {.radiance = {x, x, x}});
    film.add(1, 0, {.radiance = {0.3f, 0.3f, 0.3f}});
    light.push_back(double(x));
  }
  double mean = 0, squares = 0;
  for (const double x : light) mean += x / 50;
  for (const double x : light) squares += (x - mean) * (x - mean);
  const Image variance = film.develop(Aov::Variance);
  EXPECT_NEAR(variance.pixels[0], squares / 49 / 50, 1e-6);
  EXPECT_EQ(variance.pixels[1], 0);  // equal samples have none
  EXPECT_NEAR(film.statistics(0, 0).mean, mean, 1e-6);
}

TEST(FilmAovs, CostsAreSums) {
  Film film({0, 0, 1, 1}, 1, parse_aovs("cost.time,cost.expand,cost.reexpand"));
  ASSERT_TRUE(film.wants_costs());
  for (int i = 0; i < 4; ++i) film.add(0, 0, {.nanoseconds = 250'000'000, .expansions = {3, 1}});
  EXPECT_EQ(film.develop(Aov::CostTime).pixels, (std::vector<float>{1}));
  EXPECT_EQ(film.develop(Aov::CostExpand).pixels, (std::vector<float>{12}));
  EXPECT_EQ(film.develop(Aov::CostReexpand).pixels, (std::vector<float>{4}));
}

TEST(FilmAovs, LightBeyondTheSumsIsCountedLikeInfinity) {
  Film film({0, 0, 1, 1}, 1);
  film.add(0, 0, {.radiance = {1, 1, 1}});
  film.add(0, 0, {.radiance = {5e12f, 1, 1}});
  EXPECT_EQ(film.nonfinite_samples(), 1u);
  EXPECT_EQ(film.develop().pixels[0], 1);
}

TEST(Aovs, NamesAreFoundAndOthersRefused) {
  EXPECT_EQ(parse_aovs("Z,albedo,Z"), (std::vector{Aov::Albedo, Aov::Z}));
  EXPECT_EQ(parse_aovs("all").size(), aov_infos().size());
  for (const AovInfo& info : aov_infos()) {
    EXPECT_EQ(&info_of(info.aov), &info);
    EXPECT_EQ(aov_named(info.name), info.aov);
  }
  EXPECT_THROW(parse_aovs("albedo,depth"), std::invalid_argument);
  EXPECT_THROW(parse_aovs(""), std::invalid_argument);
}

}  // namespace
}  // namespace meristem
