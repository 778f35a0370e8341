// What every camera promises of its projection and its footprints.
#pragma once

#include "geometry/base/key.h"
#include "renderer/scene/interfaces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

namespace meristem {

// What lies on the ray of a film position is seen there.
inline void expect_projection_back(const Camera& camera, std::initializer_list<Vec2f> films, int width, int height) {
  for (const Vec2f film : films) {
    const Ray ray = camera.ray({film, {}}, width, height);
    const auto found = camera.project(Vec3d(ray.origin + ray.direction * 7), width, height);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->x, film.x, 2e-3f);
    EXPECT_NEAR(found->y, film.y, 2e-3f);
  }
}

// Where a matrix of CameraMatrices takes a position.
inline Vec3d transformed(Vec3d p, const CameraMatrices::Matrix& m) {
  const auto column = [&](std::size_t c) { return p.x * m[c] + p.y * m[4 + c] + p.z * m[8 + c] + m[12 + c]; };
  return Vec3d{column(0), column(1), column(2)} / column(3);
}

// What other programs compute by the matrices is what the camera sees.
inline void expect_matrices(const Camera& camera, int width, int height) {
  const auto matrices = camera.matrices(width, height);
  ASSERT_TRUE(matrices);
  const Ray middle = camera.ray({{0.5f * float(width), 0.5f * float(height)}, {}}, width, height);
  const Ray above = camera.ray({{0.5f * float(width), 0.4f * float(height)}, {}}, width, height);
  for (const Vec2f film : {Vec2f{0, 0}, Vec2f{10.25f, 20}, Vec2f{float(width), float(height)}, Vec2f{70, 90}}) {
    const Ray ray = camera.ray({film, {}}, width, height);
    const Vec3d position(ray.origin + ray.direction * 7);
    if (matrices->world_to_picture) {
      const Vec3d seen = transformed(position, *matrices->world_to_picture);
      EXPECT_NEAR(seen.x * width, film.x, 2e-3);
      EXPECT_NEAR(seen.y * height, film.y, 2e-3);
    }
    const Vec3d from_camera = transformed(position, matrices->world_to_camera);
    if (matrices->world_to_picture) {
      EXPECT_GT(from_camera.z, 0) << "z points into the picture";
    }
    const Vec3d origin = transformed(Vec3d(ray.origin), matrices->world_to_camera);
    EXPECT_NEAR(length(from_camera - origin), 7, 1e-4) << "a matrix that moves and turns";
  }
  const auto turned = [&](Vec3f d) {
    return transformed(Vec3d(d), matrices->world_to_camera) - transformed({}, matrices->world_to_camera);
  };
  const Vec3f up = above.direction * 5 + above.origin - middle.direction * 5 - middle.origin;
  EXPECT_GT(turned(up).y, 0);
  if (!camera.has_axis()) return;
  const Ray axis = camera.axis(0, width, height);
  EXPECT_NEAR(length(turned(axis.direction) - Vec3d{0, 0, 1}), 0, 1e-5) << "along which depth is measured";
}

// 300 spheres around the origin, up to `reach` away and `radius` large. Returns of how many the least is known.
inline int expect_footprints_in_range(const Camera& camera, float reach, float largest, int width, int height) {
  auto random = [i = Key(0)]() mutable { return 2 * uniform_double(hash_keys(5, ++i)) - 1; };
  const auto random_vector = [&] { return Vec3f(Vec3d{random(), random(), random()}); };
  int known = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3f center = random_vector() * reach;
    const float radius = 0.5f * largest * float(1 + random());
    const auto [least, most] = camera.footprint_range(center, radius, width, height);
    known += least > 0;
    for (int k = 0; k < 100; ++k) {
      const float footprint = camera.footprint(center + random_vector() * (radius / std::sqrt(3.f)), width, height);
      EXPECT_LE(least, footprint);
      EXPECT_GE(most, footprint);
    }
  }
  return known;
}

}  // namespace meristem
