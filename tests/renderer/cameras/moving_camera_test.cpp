#include "renderer/cameras/moving_camera.h"

#include "tests/support/component.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace meristem {
void register_pinhole(CameraRegistry& r);

namespace {

constexpr int width = 320, height = 200;

std::unique_ptr<Camera> standing(double x) {
  return make<Camera>(register_pinhole, fmt::format(R"({{ "from": [{}, 0, 5], "to": [{}, 0, 0] }})", x, x));
}

std::unique_ptr<Camera> moving() {
  std::vector<std::unique_ptr<Camera>> keys;
  for (int i = 0; i <= 4; ++i) keys.push_back(standing(0.5 * i));
  return std::make_unique<MovingCamera>(std::move(keys));
}

TEST(MovingCamera, StandsWhereItIsAtTheTimeOfTheRay) {
  const auto camera = moving();
  for (const float time : {0.f, 0.1f, 0.25f, 0.77f}) {
    const Ray ray = camera->ray({{40, 60}, {}, time}, width, height),
              expected = standing(2 * double(time))->ray({{40, 60}, {}}, width, height);
    EXPECT_LT(length(ray.origin - expected.origin), 1e-6f);
    EXPECT_LT(length(ray.direction - expected.direction), 1e-6f);
    EXPECT_EQ(ray.time, time);
  }
}

TEST(MovingCamera, FootprintIsTheLeastAtAnyTime) {
  const auto camera = moving();
  const Vec3f aside{-3, 0, 3};
  float least = standing(0)->footprint(aside, width, height);
  for (int i = 0; i <= 4; ++i) least = std::min(least, standing(0.5 * i)->footprint(aside, width, height));
  EXPECT_EQ(camera->footprint(aside, width, height), least);
}

// Not the least: a camera that moves towards what it sees would have none at all.
TEST(MovingCamera, SpreadIsThatOfTheNearestKey) {
  std::vector<std::unique_ptr<Camera>> keys;
  for (const char* from : {"[0, 0, 5]", "[0, 0, 4]", "[0, 0, 3]"})
    keys.push_back(make<Camera>(register_pinhole, fmt::format(R"({{ "from": {}, "to": [0, 0, 0] }})", from)));
  const MovingCamera camera(std::move(keys));
  const auto still = make<Camera>(register_pinhole, R"({ "from": [0, 0, 5], "to": [0, 0, 0] })");
  const float expected = still->cone(still->ray({{40, 60}, {}}, width, height), width, height).spread;
  EXPECT_GT(expected, 0);
  for (const float time : {0.f, 0.3f, 0.9f})
    EXPECT_NEAR(camera.cone(camera.ray({{40, 60}, {}, time}, width, height), width, height).spread, expected, 1e-6f);
}

TEST(MovingCamera, ProjectsFromWhereItIsWhenTheShutterOpens) {
  EXPECT_EQ(moving()->project({1, 1, 0}, width, height), standing(0)->project({1, 1, 0}, width, height));
}

}  // namespace
}  // namespace meristem
