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
