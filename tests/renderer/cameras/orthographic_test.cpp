#include "tests/renderer/cameras/camera_promises.h"
#include "tests/support/component.h"

#include <gtest/gtest.h>

namespace meristem {
void register_orthographic(CameraRegistry& r);

namespace {

constexpr int width = 320, height = 200;

std::unique_ptr<Camera> camera() {
  return make<Camera>(register_orthographic, R"({ "from": [0, 0, 10], "to": [0, 0, 0], "height": 4 })");
}

TEST(Orthographic, RaysAreParallelAndAPixelApart) {
  const auto c = camera();
  const Ray a = c->ray({{100, 50}, {}}, width, height), b = c->ray({{101, 50}, {}}, width, height);
  const Ray below = c->ray({{100, 51}, {}}, width, height);
  EXPECT_EQ(a.direction, (Vec3f{0, 0, -1}));
  EXPECT_EQ(b.direction, a.direction);
  EXPECT_LT(length(b.origin - a.origin - Vec3f{4.f / height, 0, 0}), 1e-5f);
  EXPECT_LT(length(below.origin - a.origin - Vec3f{0, -4.f / height, 0}), 1e-5f);
}

TEST(Orthographic, ShowsItsHeight) {
  const auto c = camera();
  EXPECT_NEAR(c->ray({{160, 0}, {}}, width, height).origin.y, 2, 1e-6f);
  EXPECT_NEAR(c->ray({{160, 200}, {}}, width, height).origin.y, -2, 1e-6f);
  EXPECT_NEAR(c->ray({{320, 100}, {}}, width, height).origin.x, 3.2, 1e-6f);
}

TEST(Orthographic, ProjectFindsTheFilmPositionOfARay) {
  const auto c = make<Camera>(register_orthographic, R"({ "from": [3, 2, 5], "to": [0, 1.5, 0], "height": 0.5 })");
  expect_projection_back(*c, {{160, 100}, {10.25f, 20}, {-40, 300}}, width, height);
  expect_matrices(*c, width, height);
  const Ray ray = c->ray({{160, 100}, {}}, width, height);
  EXPECT_FALSE(c->project(Vec3d(ray.origin - ray.direction), width, height));
}

TEST(Orthographic, APixelHasOneSizeInView) {
  const auto c = camera();
  for (const Vec3f p : {Vec3f{0, 0, 10}, Vec3f{0, 0, -1000}, Vec3f{3.1f, -1.9f, 2}})
    EXPECT_EQ(c->footprint(p, width, height), 4.f / height);
  const Ray ray = c->ray({{3, 5}, {}}, width, height);
  EXPECT_EQ(c->cone(ray, width, height).width, 4.f / height);
  EXPECT_EQ(c->cone(ray, width, height).spread, 0);
}

TEST(Orthographic, FootprintGrowsGentlyOutOfView) {
  const auto c = camera();
  float before = c->footprint({0, 0, 0}, width, height);
  for (int i = 1; i <= 2000; ++i) {  // out at the side, and then back behind the camera
    const Vec3f p = i <= 1000 ? Vec3f{0.02f * float(i), 0, 0} : Vec3f{20, 0, 0.02f * float(i - 1000)};
    const float now = c->footprint(p, width, height);
    EXPECT_GE(now, before);
    EXPECT_LT(now, before + 0.01f * 4 / height);
    before = now;
  }
  EXPECT_GT(before, 4 * 4.f / height);
}

TEST(Orthographic, FootprintsInASphereStayInTheirRange) {
  EXPECT_EQ(expect_footprints_in_range(*camera(), 20, 6, width, height), 300);
}

TEST(Orthographic, ReportsViewsThatAreNone) {
  EXPECT_THROW(make<Camera>(register_orthographic, R"({ "from": [1, 1, 1], "to": [1, 1, 1] })"), SceneErrors);
  EXPECT_THROW(make<Camera>(register_orthographic, R"({ "height": 0 })"), SceneErrors);
}

}  // namespace
}  // namespace meristem
