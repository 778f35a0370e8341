// Choosing among many lights: probabilities are those of the choices made, nothing that gives light is left out, and
// what is estimated by one chosen light is the sum over all of them.
#include "renderer/integrators/light_choice.h"

#include "geometry/base/key.h"
#include "renderer/scene/warps.h"
#include "tests/support/component.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace meristem {
void register_constant(LightRegistry& r);
void register_distant(LightRegistry& r);
void register_rectangle(LightRegistry& r);
void register_sphere(LightRegistry& r);

namespace {

float random_number(Key i, Key what) { return uniform_float(hash_keys(i, what)); }
Vec3f random_vector(Key i, Key what) {
  return Vec3f{random_number(i, what), random_number(i, what + 1), random_number(i, what + 2)} * 2 - Vec3f(1);
}

std::string text_of(Vec3f v) { return fmt::format("[{}, {}, {}]", v.x, v.y, v.z); }

using Lights = std::vector<std::unique_ptr<Light>>;

// Lamps of all sizes, brightnesses and directions in a box of 20 m.
Lights lamps(int count) {
  Lights lights;
  for (int i = 0; i < count; ++i) {
    const auto key = Key(i);
    const Vec3f place = random_vector(key, 0) * 10;
    const float size = 0.02f + 0.5f * std::pow(random_number(key, 6), 4.f);
    const float intensity = 20 * std::pow(random_number(key, 7), 3.f);
    lights.push_back(
        i % 3 ? make<Light>(register_rectangle, fmt::format(R"({{ "from": {}, "to": {}, "width": {}, "height": {},
                                                           "intensity": {}, "two_sided": {} }})",
                                                            text_of(place), text_of(place + random_vector(key, 3)),
                                                            size, 2 * size, intensity, i % 6 == 1))
              : make<Light>(register_sphere, fmt::format(R"({{ "center": {}, "radius": {}, "intensity": {} }})",
                                                         text_of(place), size, intensity)));
  }
  return lights;
}

Receiver random_receiver(Key i) { return {random_vector(i, 10) * 9, normalize(random_vector(i, 13))}; }

// The light that a receiver gets from one light, by a fixed set of samples: on its upper side, or from all around.
double received(const Light& light, const Receiver& receiver) {
  constexpr int side = 4;
  double sum = 0;
  for (int i = 0; i < side * side; ++i) {
    const LightSample s =
        light.sample(receiver.position, {(float(i % side) + 0.5f) / side, (float(i / side) + 0.5f) / side});
    if (!(s.pdf > 0)) continue;
    const float cosine = receiver.normal == Vec3f{} ? 1 : std::max(0.f, dot(s.direction, receiver.normal));
    sum += double(luminance(s.radiance) * cosine / s.pdf) / (side * side);
  }
  return sum;
}

TEST(LightChoice, ProbabilitiesAreThoseOfTheChoices) {
  Lights lights = lamps(40);
  lights.push_back(make<Light>(register_constant));
  lights.push_back(make<Light>(register_distant));
  const LightChoice choice(lights);
  for (Key r = 0; r < 20; ++r) {
    const Receiver receiver = random_receiver(r);
    std::vector<int> found(lights.size());
    constexpr int count = 20000;
    int none = 0;  // the way down the tree has ended where nothing reaches the receiver
    for (int i = 0; i < count; ++i) {
      const LightChoice::Pick pick = choice.pick(receiver, (float(i) + 0.5f) / count);
      if (pick.light < 0) {
        ++none;
        continue;
      }
      ++found[std::size_t(pick.light)];
      ASSERT_FLOAT_EQ(pick.probability, choice.probability(receiver, std::size_t(pick.light)));
    }
    double sum = 0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
      const double p = double(choice.probability(receiver, i));
      EXPECT_NEAR(found[i], p * count, 1 + 1e-3 * count) << i;
      sum += p;
    }
    EXPECT_NEAR(sum, 1 - double(none) / count, 1e-3);
  }
}

TEST(LightChoice, WhoeverGivesLightMayBeChosen) {
  const Lights lights = lamps(500);
  const LightChoice choice(lights);
  int unreachable = 0;
  for (Key r = 0; r < 100; ++r)
    for (std::size_t i = 0; i < lights.size(); ++i) {
      const Receiver receiver = random_receiver(r);
      const bool possible = choice.probability(receiver, i) > 0;
      if (possible) continue;
      ++unreachable;
      EXPECT_LT(received(*lights[i], receiver), 1e-5) << i;
    }
  EXPECT_GT(unreachable, 10000);  // of 50,000: those that shine away, or stand behind the receiver
}

// Each estimate asks one light. The tree's mean is the sum over all, as that of uniform choice is, with far less noise.
TEST(LightChoice, OneOfThousandsEstimatesTheSumOfAll) {
  const Lights lights = lamps(3000);
  const LightChoice choice(lights);
  for (Key r = 0; r < 4; ++r) {
    Receiver receiver = random_receiver(r);
    if (r == 3) receiver.normal = {};
    std::vector<double> given;
    double exact = 0, uniform_square = 0;
    for (const auto& light : lights) given.push_back(received(*light, receiver));
    for (const double g : given) exact += g, uniform_square += g * g * double(lights.size());
    constexpr int count = 20000;
    double sum = 0, square = 0;
    for (int i = 0; i < count; ++i) {
      const LightChoice::Pick pick = choice.pick(receiver, random_number(Key(i), 20));
      if (pick.light < 0) continue;
      const double value = given[std::size_t(pick.light)] / double(pick.probability);
      sum += value / count;
      square += value * value / count;
    }
    const double variance = square - sum * sum, uniform_variance = uniform_square - exact * exact;
    EXPECT_NEAR(sum, exact, 4 * std::sqrt(variance / count));
    EXPECT_LT(variance, uniform_variance / 4) << r;
  }
}

// Nothing hangs on how large the scene is: beside a lamp the lamp is asked, far from it the sky.
TEST(LightChoice, WeighsEnvironmentsByWhatTheyGive) {
  Lights lights;
  lights.push_back(make<Light>(register_distant, R"({ "irradiance": 12 })"));
  lights.push_back(make<Light>(register_sphere, R"({ "center": [0, 1, 0], "radius": 0.2, "intensity": 20 })"));
  const LightChoice choice(lights);
  EXPECT_GT(choice.probability({{0, 0.7f, 0}, {0, 1, 0}}, 1), 0.6f);
  EXPECT_GT(choice.probability({{0, -100, 0}, {0, 1, 0}}, 0), 0.7f);
  EXPECT_GT(choice.probability({{0, -100, 0}, {0, 1, 0}}, 1), 0.2f);
  EXPECT_EQ(choice.probability({{0, 0.5f, 0}, {0, -1, 0}}, 1), 0);  // it faces away
}

TEST(LightChoice, LeavesUniformEnvironmentsToTheBounces) {
  Lights lights;
  lights.push_back(make<Light>(register_constant));
  const LightChoice alone(lights);
  EXPECT_FALSE(alone.asks());
  EXPECT_EQ(alone.pick({}, 0.5f).light, -1);
  EXPECT_EQ(alone.probability({}, 0), 0);
  EXPECT_FLOAT_EQ(alone.mean_background(), 1);
  lights.push_back(make<Light>(register_distant));
  const LightChoice with_sun(lights);
  EXPECT_TRUE(with_sun.asks());
  EXPECT_EQ(with_sun.environments().size(), 2u);
  EXPECT_EQ(with_sun.pick({}, 0).light, 1);
  EXPECT_EQ(with_sun.probability({}, 1), 1);
}

TEST(LightTree, FindsWhatARayCrosses) {
  const Lights lights = lamps(800);
  const LightChoice choice(lights);
  int met = 0;
  for (Key i = 0; i < 4000; ++i) {
    Ray ray;
    ray.origin = random_vector(i, 30) * 10;
    ray.direction = normalize(random_vector(i, 33));
    std::vector<bool> visited(lights.size());
    choice.tree().visit_crossed(ray, 15, [&](std::size_t light) { visited[light] = true; });
    for (std::size_t k = 0; k < lights.size(); ++k)
      if (lights[k]->intersect(ray) < 15) {
        ++met;
        EXPECT_TRUE(visited[k]);
      }
  }
  EXPECT_GT(met, 100);
}

TEST(LightTree, HoldsLightsInOnePlaceAndNone) {
  EXPECT_EQ(LightTree({}).pick({}, 0.5f).light, -1);
  std::vector<LightBounds> same(1000);
  for (LightBounds& b : same) b.box = {{1, 1, 1}, {1, 1, 1}}, b.power = 2;
  same[7].power = 0;
  const LightTree tree(same);
  EXPECT_EQ(tree.probability({}, 7), 0);
  EXPECT_NEAR(tree.probability({}, 8), 1.0 / 999, 2e-4);
}

}  // namespace
}  // namespace meristem
