// What every light must keep: densities integrate to 1, and sample() agrees with what rays meet.
#include "renderer/lights/distribution_2d.h"
#include "renderer/scene/warps.h"
#include "tests/support/component.h"

#include <gtest/gtest.h>

namespace meristem {
void register_constant(LightRegistry& r);
void register_distant(LightRegistry& r);
void register_rectangle(LightRegistry& r);
void register_sky(LightRegistry& r);
void register_sphere(LightRegistry& r);

namespace {

Vec2f random_pair(int i, int what = 0) {
  return {uniform_float(hash_keys(Key(i), Key(what), 1)), uniform_float(hash_keys(Key(i), Key(what), 2))};
}
// Evenly spread points: additive recurrence with the plastic number (Roberts 2018).
Vec2f spread_pair(int i) {
  const double x = 0.5 + 0.7548776662466927 * i, y = 0.5 + 0.5698402909980532 * i;
  return {float(x - std::floor(x)) * 0.999999f, float(y - std::floor(y)) * 0.999999f};
}

struct Case {
  const char* name;
  void (*registration)(LightRegistry&);
  const char* parameters;
  Vec3f center{};           // of a shape,
  float one_minus_cos = 2;  // and a cone around it from the origin that holds it
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class Environment : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(, Environment,
                         testing::Values(Case{"constant", register_constant, R"({ "color": [1, 2, 3] })"},
                                         Case{"wide_distant", register_distant, R"({ "angle": 40 })"},
                                         Case{"day", register_sky, R"({ "sun_size": 10 })"},
                                         Case{"low_sun", register_sky,
                                              R"({ "elevation": 3, "sun_size": 20, "turbidity": 6 })"},
                                         Case{"dusk", register_sky, R"({ "elevation": -5 })"}),
                         [](const auto& test) { return test.param.name; });

TEST_P(Environment, PdfIntegratesToOne) {
  const auto light = make<Light>(GetParam().registration, GetParam().parameters);
  constexpr int count = 200000;
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += double(light->escaped(uniform_cone(2, spread_pair(i))).pdf);
  EXPECT_NEAR(sum * 4 * pi / count, 1, 0.01);
}

TEST_P(Environment, SamplesAreWhatEscapedRaysMeet) {
  const auto light = make<Light>(GetParam().registration, GetParam().parameters);
  for (int i = 0; i < 2000; ++i) {
    const LightSample s = light->sample({1, 2, 3}, random_pair(i));
    ASSERT_GT(s.pdf, 0);
    EXPECT_NEAR(length(s.direction), 1, 1e-5f);
    EXPECT_EQ(s.distance, std::numeric_limits<float>::infinity());
    ASSERT_TRUE(is_finite(s.radiance));
    if (GetParam().registration == &register_distant) continue;  // a sample on the rim may round out of the cone
    const EscapedLight met = light->escaped(s.direction);
    EXPECT_LE(max_component(abs(s.radiance - met.radiance)), 1e-4f * max_component(met.radiance));
    EXPECT_NEAR(s.pdf / met.pdf, 1, 1e-4f);
  }
}

// The same integral by light samples and by uniform directions: the luminance over the sphere, weighted with a tilted
// lobe.
TEST_P(Environment, SamplingGivesTheSameLightAsUniformDirections) {
  const auto light = make<Light>(GetParam().registration, GetParam().parameters);
  auto weight = [](Vec3f d) { return 1 + dot(d, normalize(Vec3f{1, 2, -1})); };
  constexpr int count = 200000;
  double by_light = 0, uniform = 0;
  for (int i = 0; i < count; ++i) {
    const LightSample s = light->sample({}, spread_pair(i));
    by_light += double(luminance(s.radiance) * weight(s.direction) / s.pdf);
    const Vec3f d = uniform_cone(2, spread_pair(i));
    uniform += double(luminance(light->escaped(d).radiance) * weight(d)) * 4 * pi;
  }
  EXPECT_NEAR(by_light / uniform, 1, 0.015);
}

TEST_P(Environment, PowerIsTheLightOverTheScenesDisk) {
  const auto light = make<Light>(GetParam().registration, GetParam().parameters);
  double flux = 0;
  constexpr int count = 20000;
  for (int i = 0; i < count; ++i) {
    const LightSample s = light->sample({}, spread_pair(i));
    flux += double(luminance(s.radiance) / s.pdf) / count;
  }
  EXPECT_NEAR(light->environment_power() / flux, 1, 0.05);
}

TEST(Distant, IrradianceDoesNotDependOnTheAngle) {
  for (const char* text : {R"({ "angle": 0 })", R"({ "angle": 0.5 })", R"({ "angle": 60 })"}) {
    const auto light = make<Light>(register_distant, text);
    const Vec3f axis = normalize(Vec3f{1, 1, 1});
    double irradiance = 0;
    for (int i = 0; i < 4000; ++i) {
      const LightSample s = light->sample({}, spread_pair(i));
      irradiance += double(s.radiance.x * dot(s.direction, axis) / s.pdf) / 4000;
    }
    EXPECT_NEAR(irradiance, 3, 0.01) << text;
  }
}

TEST(Sky, LooksLikeAClearDay) {
  const auto sky = make<Light>(register_sky, R"({ "elevation": 40, "azimuth": 0, "sun_intensity": 0 })");
  const Spectrum zenith = sky->escaped({0, 1, 0}).radiance, away = sky->escaped(normalize(Vec3f{0, 1, -1})).radiance;
  const Spectrum horizon = sky->escaped(normalize(Vec3f{0, 0.02f, -1})).radiance;
  const Spectrum near_sun = sky->escaped(normalize(Vec3f{0, 1, 1})).radiance;
  EXPECT_GT(zenith.z, 2 * zenith.x);                             // blue
  EXPECT_LT(horizon.z / horizon.x, 0.6f * zenith.z / zenith.x);  // whiter below
  EXPECT_GT(luminance(horizon), luminance(zenith));              // and brighter
  EXPECT_GT(luminance(near_sun), 2 * luminance(away));           // haze around the sun
  EXPECT_EQ(sky->escaped({0, -1, 0}).radiance, sky->escaped(normalize(Vec3f{1, -0.2f, 0})).radiance);
}

TEST(Sky, SunReddensAndWeakensAsItSets) {
  auto sun_at = [](const char* text, double elevation) {
    const auto sky = make<Light>(register_sky, text);
    return sky->escaped(Vec3f(Vec3d{0, std::sin(elevation * pi / 180), std::cos(elevation * pi / 180)})).radiance;
  };
  const Spectrum high = sun_at(R"({ "elevation": 60, "azimuth": 0 })", 60);
  const Spectrum low = sun_at(R"({ "elevation": 3, "azimuth": 0 })", 3);
  EXPECT_LT(low.z / low.x, 0.3f * high.z / high.x);
  EXPECT_LT(luminance(low), 0.4f * luminance(high));
}

// Noon: what a white floor reflects, and the sun's strength whatever its size.
TEST(Sky, WhitePaperInTheNoonSunIsAboutOne) {
  for (const char* text : {R"({ "elevation": 70 })", R"({ "elevation": 70, "sun_size": 8 })"}) {
    const auto sky = make<Light>(register_sky, text);
    double irradiance = 0;
    for (int i = 0; i < 20000; ++i) {
      const LightSample s = sky->sample({}, spread_pair(i));
      irradiance += double(luminance(s.radiance) * std::max(0.f, s.direction.y) / s.pdf) / 20000;
    }
    EXPECT_NEAR(irradiance / pi, 1.1, 0.15) << text;
  }
}

class Shape : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    , Shape,
    testing::Values(
        Case{"rectangle",
             register_rectangle,
             R"({ "from": [1, 3, 0], "to": [0, 0, 0], "width": 2, "height": 1 })",
             {1, 3, 0},
             0.15f},
        Case{"tiny_rectangle",
             register_rectangle,
             R"({ "from": [1, 3, 0], "width": 0.003, "height": 0.001 })",
             {1, 3, 0},
             2e-7f},
        Case{"sphere", register_sphere, R"({ "center": [1, 3, 0], "radius": 1 })", {1, 3, 0}, 0.08f},
        Case{"far_sphere", register_sphere, R"({ "center": [1, 300, 0], "radius": 0.5 })", {1, 300, 0}, 3e-6f}),
    [](const auto& test) { return test.param.name; });

TEST_P(Shape, SamplesLieOnTheShapeThatRaysMeet) {
  const auto light = make<Light>(GetParam().registration, GetParam().parameters);
  int met = 0;
  constexpr int count = 2000;
  for (int i = 0; i < count; ++i) {
    const Vec2f place = random_pair(i, 7);
    const Vec3f from{place.x - 0.5f, 0, place.y - 0.5f};
    const LightSample s = light->sample(from, random_pair(i));
    ASSERT_GT(s.pdf, 0);
    Ray ray;
    ray.origin = from;
    ray.direction = s.direction;
    const float t = light->intersect(ray);
    if (!(t < INFINITY)) continue;  // on the rim, by rounding
    ++met;
    EXPECT_NEAR(t / s.distance, 1, 1e-3f);
    EXPECT_EQ(light->emitted(ray, t), s.radiance);
    EXPECT_NEAR(light->pdf_hit(ray, t) / s.pdf, 1, 1e-3f);
  }
  EXPECT_GT(met, count * 99 / 100);
}

TEST_P(Shape, PdfIntegratesToOneOverTheShape) {
  const auto light = make<Light>(GetParam().registration, GetParam().parameters);
  const Frame cone(normalize(GetParam().center));
  double sum = 0;
  constexpr int count = 200000;
  for (int i = 0; i < count; ++i) {
    Ray ray;
    ray.direction = cone.to_world(uniform_cone(GetParam().one_minus_cos, spread_pair(i)));
    if (const float t = light->intersect(ray); t < INFINITY) sum += double(light->pdf_hit(ray, t));
  }
  EXPECT_NEAR(sum / count / double(uniform_cone_pdf(GetParam().one_minus_cos)), 1, 0.02);
}

TEST_P(Shape, InvisibleOnesAreHiddenFromTheCameraAlone) {
  const std::string text = GetParam().parameters;
  const auto seen = make<Light>(GetParam().registration, text);
  const auto hidden = make<Light>(GetParam().registration, text.substr(0, text.size() - 1) + R"(, "visible": false })");
  EXPECT_TRUE(seen->seen_by_camera());
  EXPECT_FALSE(hidden->seen_by_camera());
  const LightSample a = seen->sample({0.2f, 0, 0.1f}, {0.3f, 0.7f}), b = hidden->sample({0.2f, 0, 0.1f}, {0.3f, 0.7f});
  EXPECT_FALSE(b.is_delta);
  EXPECT_EQ(b.pdf, a.pdf);
  EXPECT_EQ(b.radiance, a.radiance);
  Ray ray;
  ray.origin = {0.2f, 0, 0.1f};
  ray.direction = a.direction;
  EXPECT_EQ(hidden->intersect(ray), seen->intersect(ray));
}

double irradiance(const Light& light, Vec3f from, Vec3f normal) {
  double sum = 0;
  constexpr int count = 50000;
  for (int i = 0; i < count; ++i) {
    const LightSample s = light.sample(from, spread_pair(i));
    if (s.pdf > 0) sum += double(s.radiance.x * std::max(0.f, dot(s.direction, normal)) / s.pdf);
  }
  return sum / count;
}

// A sphere wholly above the horizon gives L pi (r/d)^2 cos.
TEST(Sphere, IrradianceIsTheClosedForm) {
  const auto light = make<Light>(register_sphere, R"({ "center": [1, 3, 0], "radius": 0.8, "intensity": 1 })");
  const double d2 = 10, cosine = 3 / std::sqrt(d2);
  EXPECT_NEAR(irradiance(*light, {0, 0, 0}, {0, 1, 0}), pi * 0.64 / d2 * cosine, 2e-4);
}

TEST(Sphere, GivesNoLightInsideUnlessTwoSided) {
  const auto one = make<Light>(register_sphere, R"({ "center": [0, 0, 0], "radius": 2 })");
  EXPECT_EQ(one->sample({0.5f, 0, 0}, {0.5f, 0.5f}).pdf, 0);
  const auto two =
      make<Light>(register_sphere, R"({ "center": [0, 0, 0], "radius": 2, "intensity": 1, "two_sided": true })");
  EXPECT_NEAR(irradiance(*two, {0.5f, 0, 0}, {0, 1, 0}), pi, 1e-2);
}

// A rectangle a x b parallel to a surface at distance d above its corner: E / L is
// ( a/sqrt(a^2+d^2) atan(b/sqrt(a^2+d^2)) + b/sqrt(b^2+d^2) atan(a/sqrt(b^2+d^2)) ) / 2 (Lambert 1760).
TEST(Rectangle, IrradianceIsTheClosedForm) {
  const double a = 2, b = 1, d = 1.5;
  const auto light = make<Light>(register_rectangle,
                                 R"({ "from": [1, 1.5, 0.5], "to": [1, 0, 0.5], "up": [0, 0, 1],
                                     "width": 2, "height": 1, "intensity": 1 })");
  const double ra = std::hypot(a, d), rb = std::hypot(b, d);
  const double expected = 0.5 * (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb));
  EXPECT_NEAR(irradiance(*light, {0, 0, 0}, {0, 1, 0}), expected, 1e-4);
}

TEST(Rectangle, SamplingByAreaAndBySolidAngleAgree) {
  const auto light = make<Light>(register_rectangle, R"({ "from": [0, 10, 0], "to": [0, 0, 0], "up": [0, 0, 1],
                                                          "width": 0.04, "height": 0.02, "intensity": 1 })");
  // Just inside and outside of where the way of sampling changes: solid angle 1e-5 at distance 8.94
  for (float y : {1.04f, 1.08f}) {
    const double d = 10 - double(y);
    EXPECT_NEAR(irradiance(*light, {0, y, 0}, {0, 1, 0}) * d * d / 8e-4, 1, 1e-3);
  }
}

TEST(Rectangle, BackIsDarkUnlessTwoSided) {
  const auto one = make<Light>(register_rectangle, R"({ "from": [0, 3, 0], "to": [0, 0, 0], "up": [0, 0, 1] })");
  EXPECT_EQ(one->sample({0, 5, 0}, {0.5f, 0.5f}).pdf, 0);
  const auto two =
      make<Light>(register_rectangle, R"({ "from": [0, 3, 0], "to": [0, 0, 0], "up": [0, 0, 1], "two_sided": true })");
  const LightSample s = two->sample({0, 5, 0}, {0.5f, 0.5f});
  EXPECT_GT(s.pdf, 0);
  EXPECT_NEAR(s.direction.y, -1, 1e-4f);
}

TEST(Distribution2D, FollowsItsWeights) {
  const std::vector<float> weights{0, 1, 3, 0, 2, 4};
  const Distribution2D d(weights, 3, 2);
  std::vector<int> counts(6);
  constexpr int count = 60000;
  for (int i = 0; i < count; ++i) {
    const Vec2f p = d.sample(spread_pair(i));
    ++counts[std::size_t(int(p.y * 2) * 3 + int(p.x * 3))];
  }
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(double(counts[i]) / count, double(weights[i]) / 10, 0.005);
    EXPECT_NEAR(d.pdf({(float(i % 3) + 0.5f) / 3, (float(i / 3) + 0.5f) / 2}), weights[i] / 10 * 6, 1e-5f);
  }
  EXPECT_EQ(Distribution2D({0, 0}, 2, 1).pdf({0.2f, 0.5f}), 1);
}

// Even steps of the random number: as many fall in each cell of a row as it weighs, dark and bright ones in turns.
TEST(Distribution2D, FindsEveryCellOfAnUnevenRow) {
  constexpr int cells = 97, count = 100000;
  std::vector<float> weights;
  double total = 0;
  for (int i = 0; i < cells; ++i) {
    weights.push_back(i % 5 == 0 ? 0 : i % 31 == 7 ? 50 : 1e-3f * float(i));
    total += double(weights.back());
  }
  const Distribution2D d(weights, cells, 1);
  std::vector<int> found(cells);
  for (int i = 0; i < count; ++i) ++found[std::size_t(d.sample({(float(i) + 0.5f) / count, 0.5f}).x * cells)];
  for (std::size_t i = 0; i < cells; ++i) EXPECT_NEAR(found[i], double(weights[i]) / total * count, 2) << i;
}

}  // namespace
}  // namespace meristem
