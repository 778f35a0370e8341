#include "renderer/scene/motion_vectors.h"

#include "tests/support/component.h"

#include <gtest/gtest.h>

namespace meristem {
void register_pinhole(CameraRegistry& r);

namespace {

constexpr int width = 200, height = 100;

// 10 pixels to the metre in the plane z = 0.
std::unique_ptr<Camera> camera_at(const std::string& x) {
  return make<Camera>(register_pinhole, R"({ "fov": 90, "from": [)" + x + ", 0, 5], \"to\": [" + x + ", 0, 0] }");
}

SurfaceHit hit_at(Vec3f position, int object) {
  SurfaceHit hit;
  hit.t = 1;
  hit.position = position;
  hit.object = object;
  return hit;
}

void expect_near(Vec2f found, Vec2f expected) {
  EXPECT_NEAR(found.x, expected.x, 1e-4f);
  EXPECT_NEAR(found.y, expected.y, 1e-4f);
}

TEST(MotionVectors, OfAnObjectThatMovesAndTurns) {
  const auto camera = camera_at("0");
  const Affine3d quarter = Affine3d::rotation({0, 0, 1}, pi / 2);
  const MotionVectors vectors(nullptr,
                              {{Affine3d(), Affine3d::translation({1, 0.5, 0}), nullptr},
                               {Affine3d::translation({2, 0, 0}), Affine3d::translation({2, 0, 0}) * quarter, nullptr},
                               {Affine3d(), Affine3d(), nullptr}});
  expect_near(vectors.at(hit_at({0.3f, 0.1f, 0}, 0), 0, *camera, width, height), {10, -5});
  // One metre to the right of its centre comes to lie one above it
  expect_near(vectors.at(hit_at({3, 0, 0}, 1), 0, *camera, width, height), {-10, -10});
  EXPECT_EQ(vectors.at(hit_at({3, 0, 0}, 2), 0, *camera, width, height), Vec2f());
  EXPECT_EQ(vectors.at(hit_at({3, 0, 0}, -1), 0, *camera, width, height), Vec2f());
}

// A place on an object has one vector, whenever while the shutter is open it was met.
TEST(MotionVectors, AreThoseOfThePlaceNotOfTheMoment) {
  const auto camera = camera_at("0");
  auto motion = std::make_shared<Motion>();
  motion->keys = {Affine3d(), Affine3d::translation({0.5, 0, 0}) * Affine3d::scaling(Vec3d(2))};
  const MotionVectors vectors(nullptr, {{Affine3d(), Affine3d::scaling(Vec3d(3)), motion}});
  for (const float time : {0.f, 0.5f, 0.9f}) {
    const Vec3f met(motion->at(time).point({0.5, 0.25, 0}));
    expect_near(vectors.at(hit_at(met, 0), time, *camera, width, height), {10, -5});
  }
}

TEST(MotionVectors, OfACameraThatMoves) {
  const auto camera = camera_at("0");
  const MotionVectors vectors(camera_at("0.5"), {{Affine3d(), Affine3d(), nullptr}});
  expect_near(vectors.at(hit_at({0.3f, 0.1f, 0}, 0), 0, *camera, width, height), {-5, 0});
  expect_near(vectors.at(hit_at({0.3f, 0.1f, -5}, 0), 0, *camera, width, height), {-2.5f, 0});
  EXPECT_EQ(vectors.at(hit_at({0, 0, 9}, 0), 0, *camera, width, height), Vec2f());  // behind it
}

}  // namespace
}  // namespace meristem
