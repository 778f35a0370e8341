#include "tests/renderer/cameras/camera_promises.h"
#include "tests/support/component.h"

#include <gtest/gtest.h>

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
  expect_projection_back(*c, {{200, 100}, {10.25f, 20}, {395, 190}}, width, height);
  expect_matrices(*c, width, height);
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
  EXPECT_GT(expect_footprints_in_range(*camera(), 50, 6, width, height), 290);
}

}  // namespace
}  // namespace meristem
