// An outline loses no box to rounding, and is no wider than its boxes but for the margin.
#include "geometry/accel/outline.h"
#include "geometry/base/key.h"

#include <gtest/gtest.h>

#include <vector>

namespace meristem {
namespace {

float random(int i, int what) { return uniform_float(hash_keys(Key(i), Key(what))); }

// Small ones in [0, 1]^3, and all of them.
std::vector<Bounds3f> scattered(int seed, std::size_t count, Bounds3f& all) {
  std::vector<Bounds3f> boxes;
  for (std::size_t b = 0; b < count; ++b) {
    const auto at = [&](int what) { return 0.9f * random(seed, int(10 * b) + what); };
    const Vec3f lower{at(0), at(1), at(2)};
    boxes.push_back({lower, lower + Vec3f{at(3), at(4), at(5)} * 0.1f});
    all.extend(boxes.back());
  }
  return boxes;
}

// Every third along an axis.
RaySpan ray_of(int i) {
  const auto signed_random = [i](int what) { return 2 * random(i, what) - 1; };
  RaySpan ray{{3 * signed_random(101), 3 * signed_random(102), 3 * signed_random(103)}, {}, 0, 10};
  const Vec3f to{random(i, 104), random(i, 105), random(i, 106)};
  ray.direction = to - ray.origin;
  if (i % 3 == 0) {
    ray.origin = {to.x, to.y, -2};
    ray.direction = {0, 0, i % 2 ? 1.f : -1.f};
  }
  if (i % 5 == 0) ray.origin = to;
  return ray;
}

float nearest(const std::vector<Bounds3f>& boxes, float margin, const RaySpan& ray) {
  float least = std::numeric_limits<float>::infinity();
  for (const Bounds3f& b : boxes) least = std::min(least, earliest_entry(b.inflated(Vec3f(margin)), ray));
  return least;
}

TEST(Outline, IsEnteredWhereItsBoxesAre) {
  constexpr float margin = 1e-3f, step = 1.f / 250;
  int entered = 0, passed = 0;
  for (int i = 0; i < 20000; ++i) {
    Bounds3f all;
    const std::vector<Bounds3f> boxes = scattered(i, 1 + std::size_t(i) % Outline::most_boxes, all);
    const RaySpan ray = ray_of(i);
    const float entry = Outline(all, boxes, margin).entry(ray);
    EXPECT_LE(entry, nearest(boxes, 0.5f * margin, ray)) << i;
    EXPECT_GE(entry, nearest(boxes, 2 * margin + 2 * step, ray)) << i;
    entered += entry <= ray.t_max;
    passed += earliest_entry(all, ray) <= ray.t_max && entry > ray.t_max;
  }
  EXPECT_GT(entered, 500);
  EXPECT_GT(passed, 2000);  // the box is met, and nothing in it
}

}  // namespace
}  // namespace meristem
