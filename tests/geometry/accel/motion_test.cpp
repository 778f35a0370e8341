// What moves and changes while the shutter is open, ray by ray.
#include "geometry/accel/world.h"
#include "geometry/cells/placed_footprint.h"
#include "tests/support/point_footprint.h"
#include "tests/support/test_model.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace meristem {
namespace {

const CellSettings small_cells{64, 64};

std::shared_ptr<const Part> part_of(std::shared_ptr<const Model> model) {
  return std::make_shared<const Part>(std::move(model));
}

Placement placed(std::shared_ptr<const Part> part, const Affine3d& to_parent = {}) {
  return {std::move(part), to_parent, 0, true};
}

Placement moving(std::shared_ptr<const Part> part, std::vector<Affine3d> keys) {
  Placement p = placed(std::move(part), keys[0]);
  p.motion = std::make_shared<const Motion>(Motion{std::move(keys)});
  return p;
}

std::vector<Affine3d> turning(int keys, double angle) {
  std::vector<Affine3d> result;
  for (int i = 0; i < keys; ++i) result.push_back(Affine3d::rotation({0, 1, 0}, angle * i / (keys - 1)));
  return result;
}

// From all around, at all times.
Ray ray_of(int i) {
  const auto random = [i](int what) { return 2 * uniform_float(hash_keys(Key(i), Key(what))) - 1; };
  const float a = float(pi) * random(1);
  const Vec3f from{8 * std::cos(a), 4 * random(2), 8 * std::sin(a)}, to{2 * random(3), random(4), 2 * random(5)};
  Ray ray{from, normalize(to - from)};
  ray.time = uniform_float(hash_keys(Key(i), 6));
  return ray;
}

TEST(Motion, ARayMeetsAnObjectWhereItIsAtItsTime) {
  const auto cube = part_of(bumpy_model(shapes::cube(), 0, 0));
  const auto world = make_world({moving(cube, {Affine3d(), Affine3d::translation({4, 0, 2})})}, {});
  EXPECT_NEAR(world->bounds().lower.x, -1, 1e-5f);
  EXPECT_NEAR(world->bounds().upper.x, 5, 1e-5f);
  for (const float time : {0.f, 0.25f, 0.5f, 1.f}) {
    Ray ray{{4 * time + 0.5f, 0.25f, 20}, {0, 0, -1}};
    ray.time = time;
    SurfaceHit hit;
    ASSERT_TRUE(world->intersect(ray, hit));
    EXPECT_NEAR(hit.t, 20 - (2 * time + 1), 1e-5f);
    EXPECT_NEAR(hit.position.z, 2 * time + 1, 1e-5f);
    EXPECT_TRUE(world->occluded(ray));
    ray.origin.x = 4 * time + 1.1f;
    EXPECT_FALSE(world->intersect(ray, hit));
    EXPECT_FALSE(world->occluded(ray));
  }
}

// The same hit as in a world in which nothing moves and the object stands as it does at the ray's time, normals and
// all.
TEST(Motion, AHitIsThatOfTheObjectAtRest) {
  const auto cube = part_of(bumpy_model(shapes::cube(), 3, 0.2, small_cells));
  const auto keys = turning(5, 1.5);
  const Motion motion{keys};
  const auto group = std::make_shared<const Part>(std::vector<Placement>{moving(cube, keys)});
  const Affine3d stretch = Affine3d::translation({0, 0.3, 0}) * Affine3d::scaling({1.2, 0.7, 1});
  const auto world = make_world({placed(group, stretch)}, {});  // within an object that stands still
  int hits = 0;
  for (int i = 0; i < 300; ++i) {
    const Ray ray = ray_of(i);
    const auto rest = make_world({placed(cube, stretch * motion.at(ray.time))}, {});
    SurfaceHit hit, expected;
    const bool met = world->intersect(ray, hit);
    if (met != rest->intersect(ray, expected)) continue;  // grazing rays may differ by rounding
    EXPECT_EQ(world->occluded(ray), met);
    if (!met) continue;
    ++hits;
    EXPECT_NEAR(hit.t, expected.t, 1e-4f);
    EXPECT_LT(length(hit.position - expected.position), 1e-4f);
    EXPECT_LT(length(hit.geometric_normal - expected.geometric_normal), 1e-3f);
    EXPECT_LT(length(hit.shading_normal - expected.shading_normal), 1e-3f);
  }
  EXPECT_GT(hits, 50);
}

TEST(Motion, EachMomentHasItsOwnShape) {
  PartMoments moments;
  for (const double half : {0.5, 1.0, 2.0}) moments.push_back(part_of(bumpy_model(shapes::cube(half), 0, 0)));
  Placement p = placed(moments[0]);
  p.moments = std::make_shared<const PartMoments>(moments);
  const auto world = make_world({p}, {});
  EXPECT_NEAR(world->bounds().upper.x, 2, 1e-5f);
  for (const auto& [time, expected] : {std::pair(0.f, 0.5f), {0.3f, 0.5f}, {0.34f, 1.f}, {0.7f, 2.f}, {1.f, 2.f}}) {
    Ray ray{{0, 0, 9}, {0, 0, -1}};
    ray.time = time;
    SurfaceHit hit;
    ASSERT_TRUE(world->intersect(ray, hit));
    EXPECT_NEAR(hit.t, 9 - expected, 1e-6f) << time;
  }
}

// What moves within what moves, in moments, near and far.
std::vector<Placement> everything_moves() {
  const auto cube = part_of(bumpy_model(shapes::cube(), 3, 0.2, small_cells)),
             other = part_of(bumpy_model(shapes::prism(8, 0.7), 3, 0.2, small_cells));
  Placement grows = placed(cube, Affine3d::translation({-1.5, 0, 0}));
  grows.moments = std::make_shared<const PartMoments>(PartMoments{cube, other, cube});
  grows.individual = 5;
  const auto pair = std::make_shared<const Part>(std::vector<Placement>{grows, moving(other, turning(3, 2))});
  return {moving(pair, {Affine3d(), Affine3d::translation({0.5, 0.2, 0}), Affine3d::scaling({1, 1.3, 1})}),
          placed(pair, Affine3d::translation({0, -3, 1})), grows};
}

struct Found {
  bool met;
  float t;
  Vec3f position, normal;
  int object;
  Key face;
  bool operator==(const Found&) const = default;
};

Found found(bool met, const SurfaceHit& hit) {
  return met ? Found{true, hit.t, hit.position, hit.shading_normal, hit.object, hit.origin.key} : Found{};
}

TEST(Motion, HitsHaveTheSameBitsHoweverTheyAreFound) {
  const auto footprint = std::make_shared<const PointFootprint>(Vec3d(6, 0, 0), 0.02);
  const auto eager = make_world(everything_moves(), {.mode = ExpandMode::Eager, .footprint = footprint}),
             lazy = make_world(everything_moves(), {.budget_bytes = 200 << 10, .footprint = footprint}),
             waiting = make_world(everything_moves(), {.budget_bytes = 200 << 10, .footprint = footprint}),
             flat = make_world(everything_moves(), {.mode = ExpandMode::Flat, .footprint = footprint});
  int hits = 0, ties = 0;
  for (int i = 0; i < 1000; ++i) {
    const Ray ray = ray_of(i);
    SurfaceHit hit;
    const bool met = eager->intersect(ray, hit);
    const Found expected = found(met, hit);
    hits += met;
    EXPECT_EQ(found(lazy->intersect(ray, hit), hit), expected);
    RaySearch search;
    RaySearch::End end = RaySearch::End::Waits;
    while (end == RaySearch::End::Waits) end = waiting->search(ray, false, search, hit);
    EXPECT_EQ(found(end == RaySearch::End::Met, hit), expected);
    EXPECT_EQ(lazy->occluded(ray), met);
    end = RaySearch::End::Waits;
    while (end == RaySearch::End::Waits) end = waiting->search(ray, true, search, hit);
    EXPECT_EQ(end == RaySearch::End::Met, met);
    ties += flat->intersect(ray, hit) != met || (met && hit.t != expected.t);
  }
  EXPECT_GT(hits, 200);
  EXPECT_LT(ties, 5);
  EXPECT_GT(lazy->statistics().reexpanded, 0u);
  for (const auto* world : {&eager, &lazy, &waiting}) EXPECT_TRUE((*world)->statistics().defects.empty());
}

// Near the viewer at one time only, but as fine as that asks for at all times.
TEST(Motion, DetailIsThatOfTheNearestMoment) {
  const auto cube = part_of(bumpy_model(shapes::cube(), 2, 0.1));
  const auto viewer = std::make_shared<const PointFootprint>(Vec3d(0, 0, 0), 0.01);
  const Affine3d far = Affine3d::translation({1000, 0, 0}), near = Affine3d::translation({10, 0, 0});
  const auto at = [&](const Placement& p) { return placed_footprint(viewer, p)->at(Vec3d(0)); };
  EXPECT_LE(at(moving(cube, {far, near, far})), at(placed(cube, near)));
  EXPECT_GT(at(moving(cube, {far, near, far})), 0.5 * at(placed(cube, near)));
}

}  // namespace
}  // namespace meristem
