#include "tests/support/component.h"

#include "geometry/base/key.h"

#include <gtest/gtest.h>

#include <cmath>

namespace meristem {
void register_panorama(CameraRegistry& r);

namespace {

constexpr int width = 400, height = 200;

std::unique_ptr<Camera> camera() {
  return make<Camera>(register_panorama, R"({ "from": [1, 2, 3], "to": [1, 2, 2] })");
}

void expect_direction(Vec2f film, Vec3f expected) {
  EXPECT_LT(length(camera()->ray({film, {}}, width, height).direction - expected), 1e-6f) << film.x << ", " << film.y;
}

// As the light "image" has it, which the image may serve.
TEST(Panorama, LooksAllAround) {
  expect_direction({200, 100}, {0, 0, -1});
  expect_direction({300, 100}, {1, 0, 0});
  expect_direction({100, 100}, {-1, 0, 0});
  expect_direction({0, 100}, {0, 0, 1});
  expect_direction({400, 100}, {0, 0, 1});
  expect_direction({123, 0}, {0, 1, 0});
  expect_direction({321, 200}, {0, -1, 0});
  EXPECT_EQ(camera()->ray({{7, 8}, {}}, width, height).origin, (Vec3f{1, 2, 3}));
}

TEST(Panorama, ProjectFindsTheFilmPositionOfARay) {
  const auto c = make<Camera>(register_panorama, R"({ "from": [1, 2, 3], "to": [4, 3, -2] })");
  for (const Vec2f film : {Vec2f{200, 100}, Vec2f{10.25f, 20}, Vec2f{395, 190}}) {
    const Ray ray = c->ray({film, {}}, width, height);
    const auto found = c->project(Vec3d(ray.origin + ray.direction * 7), width, height);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->x, film.x, 1e-3f);
    EXPECT_NEAR(found->y, film.y, 1e-3f);
  }
}

TEST(Panorama, FootprintIsTheDistanceBetweenPixelsAtTheHorizon) {
  const auto c = camera();
  const Ray here = c->ray({{200, 100}, {}}, width, height);
  for (const Vec2f film : {Vec2f{201, 100}, Vec2f{200, 101}}) {
    const float apart = length(c->ray({film, {}}, width, height).direction - here.direction);
    EXPECT_NEAR(c->footprint(here.origin + here.direction * 7, width, height), 7 * apart, 1e-5f);
  }
  const float high = c->footprint(here.origin + Vec3f{0, 7, 0}, width, height);
  EXPECT_NEAR(high, c->footprint(here.origin + Vec3f{0, 0, 7}, width, height), 1e-6f);
  EXPECT_NEAR(c->cone(here, width, height).spread, high / 7, 1e-6f);
}

TEST(Panorama, FootprintsInASphereStayInTheirRange) {
  const auto c = camera();
  auto random = [i = Key(0)]() mutable { return 2 * uniform_double(hash_keys(5, ++i)) - 1; };
  const auto random_vector = [&] { return Vec3f(Vec3d{random(), random(), random()}); };
  for (int i = 0; i < 300; ++i) {
    const Vec3f center = random_vector() * 50.f;
    const float radius = float(3 * (1 + random()));
    const auto [least, most] = c->footprint_range(center, radius, width, height);
    for (int k = 0; k < 100; ++k) {
      const float footprint = c->footprint(center + random_vector() * (radius / std::sqrt(3.f)), width, height);
      EXPECT_LE(least, footprint);
      EXPECT_GE(most, footprint);
    }
  }
}

}  // namespace
}  // namespace meristem
