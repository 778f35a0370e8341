#include "tests/renderer/cameras/camera_promises.h"
#include "tests/support/component.h"

#include <gtest/gtest.h>

namespace meristem {
void register_pinhole(CameraRegistry& r);
void register_thin_lens(CameraRegistry& r);

namespace {

constexpr int width = 320, height = 200;
const std::string view = R"("from": [3, 2, 5], "to": [0, 1.5, 0], "fov": 35)";

float degrees_between(Vec3f a, Vec3f b) {
  return float(std::atan2(double(length(cross(a, b))), double(dot(a, b))) * 180 / pi);
}

TEST(Pinhole, CentreOfTheImageLooksAtTo) {
  const auto camera = make<Camera>(register_pinhole, "{" + view + "}");
  const Ray ray = camera->ray({{width / 2, height / 2}, {}}, width, height);
  EXPECT_EQ(ray.origin, (Vec3f{3, 2, 5}));
  EXPECT_LT(degrees_between(ray.direction, Vec3f{0, 1.5f, 0} - ray.origin), 1e-3f);
  EXPECT_NEAR(length(ray.direction), 1, 1e-6f);
}

TEST(Pinhole, FovIsTheAngleFromTopToBottom) {
  const auto camera = make<Camera>(register_pinhole, "{" + view + "}");
  const Ray top = camera->ray({{width / 2, 0}, {}}, width, height);
  const Ray bottom = camera->ray({{width / 2, height}, {}}, width, height);
  EXPECT_NEAR(degrees_between(top.direction, bottom.direction), 35, 1e-3f);
  EXPECT_GT(top.direction.y, bottom.direction.y);
}

TEST(Pinhole, RightOfTheImageIsRight) {
  const auto camera = make<Camera>(register_pinhole, R"({ "from": [0, 0, 5], "to": [0, 0, 0] })");
  EXPECT_GT(camera->ray({{width, height / 2}, {}}, width, height).direction.x, 0);
}

TEST(Pinhole, ShiftMovesTheImageByItsHeight) {
  const auto plain = make<Camera>(register_pinhole, "{" + view + "}");
  const auto shifted = make<Camera>(register_pinhole, "{" + view + R"(, "shift_y": 0.25, "shift_x": -0.5 })");
  const Vec3f a = shifted->ray({{100, 120}, {}}, width, height).direction;
  const Vec3f b = plain->ray({{100 - 0.5f * height, 120 - 0.25f * height}, {}}, width, height).direction;
  EXPECT_LT(length(a - b), 1e-6f);
}

TEST(Pinhole, ProjectFindsTheFilmPositionOfARay) {
  const auto camera = make<Camera>(register_pinhole, "{" + view + R"(, "shift_y": 0.25, "shift_x": -0.5 })");
  expect_projection_back(*camera, {{160, 100}, {10.25f, 20}, {310, 190.5f}, {-40, 300}}, width, height);
  expect_matrices(*camera, width, height);
  const Ray ray = camera->ray({{160, 100}, {}}, width, height);
  EXPECT_FALSE(camera->project(Vec3d(ray.origin - ray.direction), width, height));
}

TEST(Pinhole, FootprintIsTheDistanceBetweenNeighbouringPixels) {
  const auto camera = make<Camera>(register_pinhole, "{" + view + "}");
  const Vec2f pixels[] = {{160, 100}, {10, 20}, {310, 190}};
  for (const Vec2f p : pixels) {
    const Ray here = camera->ray({p, {}}, width, height), below = camera->ray({{p.x, p.y + 1}, {}}, width, height);
    const Vec3f forward = camera->ray({{width / 2, height / 2}, {}}, width, height).direction;
    const float depth = 7;
    const Vec3f a = here.origin + here.direction * (depth / dot(here.direction, forward));
    const Vec3f b = below.origin + below.direction * (depth / dot(below.direction, forward));
    EXPECT_NEAR(camera->footprint(a, width, height), length(a - b), 1e-5f);
  }
}

TEST(Pinhole, FootprintsInASphereStayInTheirRange) {
  const auto camera = make<Camera>(register_pinhole, "{" + view + R"(, "shift_y": 0.25 })");
  EXPECT_GT(expect_footprints_in_range(*camera, 100, 20, width, height), 250);
  const auto far = camera->footprint_range({60000, -20000, 80000}, 20, width, height);
  EXPECT_LT(far.second, 1.02f * far.first);
}

// Around the camera they go down to nothing, but not up to anything.
TEST(Pinhole, FootprintsInASphereAroundItHaveABound) {
  const auto camera = make<Camera>(register_pinhole, R"({ "from": [0, 0, 0], "to": [0, 0, -1] })");
  const auto [least, most] = camera->footprint_range({0, 1, 0}, 5, width, height);
  EXPECT_EQ(least, 0);
  EXPECT_GE(most, camera->footprint({0, 0, 5}, width, height));
  EXPECT_LE(most, 1.5f * camera->footprint({0, 0, 5}, width, height));
}

TEST(Pinhole, FootprintGrowsGentlyAndWithoutJumpsOutOfView) {
  const auto camera = make<Camera>(register_pinhole, R"({ "from": [0, 0, 0], "to": [0, 0, -1] })");
  auto footprint = [&](double angle) {
    return camera->footprint(Vec3f(Vec3d{10 * std::sin(angle), 0, -10 * std::cos(angle)}), width, height);
  };
  constexpr int steps = 2000;
  for (int i = 1; i <= steps; ++i) {
    const float before = footprint(pi * (i - 1) / steps), after = footprint(pi * i / steps);
    EXPECT_LT(std::abs(after - before), 0.01f * footprint(0)) << i;
  }
  EXPECT_GT(footprint(pi), 2 * footprint(0));
  EXPECT_LT(footprint(pi), 10 * footprint(0));
  EXPECT_EQ(camera->footprint({0, 0, 0}, width, height), 0);
}

TEST(Pinhole, ReportsViewsThatAreNone) {
  EXPECT_THROW(make<Camera>(register_pinhole, R"({ "from": [1, 1, 1], "to": [1, 1, 1] })"), SceneErrors);
  EXPECT_THROW(make<Camera>(register_pinhole, R"({ "from": [0, 5, 0], "to": [0, 0, 0] })"), SceneErrors);
}

TEST(ThinLens, AllRaysOfAPixelMeetInTheFocusPlane) {
  const auto camera = make<Camera>(
      register_thin_lens, R"({ "from": [0, 0, 0], "to": [0, 0, -2], "aperture_radius": 0.1, "focus_distance": 4 })");
  const auto pinhole = make<Camera>(register_pinhole, R"({ "from": [0, 0, 0], "to": [0, 0, -2] })");
  const Vec2f film{40, 60};
  const Ray chief = pinhole->ray({film, {}}, width, height);
  const Vec3f focus = chief.direction * (-4 / chief.direction.z);
  for (const Vec2f lens : {Vec2f{0.1f, 0.9f}, Vec2f{0.5f, 0.5f}, Vec2f{0.99f, 0.3f}}) {
    const Ray ray = camera->ray({film, lens}, width, height);
    EXPECT_LE(length(ray.origin), 0.1f + 1e-6f);
    const Vec3f met = ray.origin + ray.direction * ((-4 - ray.origin.z) / ray.direction.z);
    EXPECT_LT(length(met - focus), 1e-5f);
  }
}

TEST(ThinLens, ProjectsThroughTheMiddleOfTheLens) {
  const auto pinhole = make<Camera>(register_pinhole, "{" + view + "}"),
             camera = make<Camera>(register_thin_lens, "{" + view + R"(, "f_stop": 1 })");
  const Vec3d p{0.4, 1.2, 0.1};
  EXPECT_EQ(camera->project(p, width, height), pinhole->project(p, width, height));
}

TEST(ThinLens, FocusesOnToUnlessTold) {
  const auto on_to = make<Camera>(register_thin_lens, R"({ "from": [0, 0, 0], "to": [0, 0, -2], "f_stop": 1 })");
  const Ray ray = on_to->ray({{width / 2, height / 2}, {0.99f, 0.5f}}, width, height);
  EXPECT_NEAR(ray.origin.x, 0.025f * 0.98f, 1e-5f);  // half of 50 mm, at 0.98 of its radius
  EXPECT_NEAR(ray.origin.x + ray.direction.x * (2 / -ray.direction.z), 0, 1e-6f);
}

}  // namespace
}  // namespace meristem
