// Classes of rays that see the world at levels of detail of their own.
#include "geometry/accel/world.h"
#include "tests/support/point_footprint.h"
#include "tests/support/test_model.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

constexpr int levels = 7;

std::shared_ptr<const Footprint> footprint_of(double pixel) {
  return std::make_shared<const PointFootprint>(Vec3d(6, 0, 0), pixel);
}

std::unique_ptr<Intersector> world_of(std::shared_ptr<const Model> model, const WorldOptions& options) {
  return make_world({{std::make_shared<const Part>(std::move(model)), Affine3d(), 0, true}}, options);
}

// From beside the camera towards places on the surface.
Ray ray_of(int i) {
  const auto random = [i](int what) { return 2 * uniform_float(hash_keys(Key(i), Key(what))) - 1; };
  const Vec3f from{6, random(1), random(2)};
  return {from, normalize(Vec3f{0, random(3), random(4)} - from)};
}

struct ClassWorldsTest : testing::Test {
  // Mean level of the faces that rays meet.
  double mean_level(RayClass ray_class, RayClass origin_class, float near = 0) const {
    double sum = 0;
    int hits = 0;
    for (int i = 0; i < 500; ++i) {
      Ray ray = ray_of(i);
      SurfaceHit hit;
      if (!world->intersect(ray, hit)) continue;
      if (near > 0) ray.origin = hit.position - ray.direction * near;
      ray.ray_class = ray_class;
      ray.origin_class = origin_class;
      if (!world->intersect(ray, hit)) continue;
      EXPECT_TRUE(world->occluded(ray));
      sum += hit.level;
      ++hits;
    }
    EXPECT_GT(hits, 250);
    return sum / hits;
  }

  static std::unique_ptr<Intersector> bumpy_world() {
    return world_of(bumpy_model(shapes::cube(), levels, 0.1, {64, 64}), {.footprint = footprint_of(0.005),
                                                                         .diffuse_footprint = footprint_of(0.04),
                                                                         .shadow_footprint = footprint_of(0.01)});
  }
  std::unique_ptr<Intersector> world = bumpy_world();
};

TEST_F(ClassWorldsTest, RaysSeeTheDetailOfTheirClass) {
  const double camera = mean_level(RayClass::Camera, RayClass::Camera);
  EXPECT_NEAR(camera - mean_level(RayClass::Shadow, RayClass::Camera), 1, 0.25) << "faces twice as large";
  EXPECT_NEAR(camera - mean_level(RayClass::Diffuse, RayClass::Camera), 3, 0.25) << "eight times";
}

// Four faces of 0.04 x 5 m from where the ray begins: so far it sees the world in which it begins.
TEST_F(ClassWorldsTest, WhatIsNearIsSeenAsTheSurfaceWhereTheRayBegins) {
  const double camera = mean_level(RayClass::Camera, RayClass::Camera, 0.4f),
               diffuse = mean_level(RayClass::Diffuse, RayClass::Diffuse, 0.4f);
  EXPECT_NEAR(mean_level(RayClass::Diffuse, RayClass::Camera, 0.4f), camera, 0.02);
  EXPECT_NEAR(mean_level(RayClass::Camera, RayClass::Diffuse, 0.4f), diffuse, 0.02);
  EXPECT_NEAR(mean_level(RayClass::Diffuse, RayClass::Camera, 1.5f), diffuse, 0.02);
}

// A surface is lit as its own world shows it: rays that leave it meet it again where those of its class do, although
// the coarser surface lies above it in half of the places.
TEST_F(ClassWorldsTest, SurfacesDoNotHideThemselves) {
  int rays = 0, differ = 0, would_differ = 0;
  for (int i = 0; i < 2000; ++i) {
    SurfaceHit hit;
    if (!world->intersect(ray_of(i), hit)) continue;
    Ray away{hit.position + hit.geometric_normal * 1e-4f, normalize(hit.geometric_normal + Vec3f{0, 0.5f, 0.3f})};
    const bool hidden = world->occluded(away);
    away.ray_class = RayClass::Diffuse;
    differ += world->occluded(away) != hidden;
    away.origin_class = RayClass::Diffuse;  // as if it began in the coarser world
    would_differ += world->occluded(away) != hidden;
    ++rays;
  }
  EXPECT_GT(rays, 1000);
  EXPECT_GT(would_differ, rays / 5);
  EXPECT_LT(differ, rays / 200);
}

// First through the world in which they begin, then through that of their class.
TEST_F(ClassWorldsTest, RaysThroughTwoWorldsMeetTheSameTogether) {
  std::vector<Ray> rays;
  for (int i = 0; i < 600; ++i) {
    Ray ray = ray_of(i);
    SurfaceHit hit;
    if (!world->intersect(ray, hit)) continue;
    ray.origin = hit.position - ray.direction * (i % 2 == 0 ? 0.003f : 0.5f);
    ray.ray_class = i % 3 == 0 ? RayClass::Shadow : RayClass::Diffuse;
    if (i % 7 == 0) ray.direction = -ray.direction;
    if (i % 5 == 0) ray.t_max = i % 10 == 0 ? 0.001f : 0.4f;
    rays.push_back(ray);
  }
  ASSERT_GT(rays.size(), 300u);
  // Of the other world little is resident at first: shadows look there twice
  const auto other = bumpy_world();
  std::vector<SurfaceHit> alone(rays.size()), together(rays.size());
  std::vector<RayQuery> queries;
  for (std::size_t i = 0; i < rays.size(); ++i)
    queries.push_back({&rays[i], rays[i].ray_class == RayClass::Shadow ? nullptr : &together[i]});
  other->intersect(ray_of(0), alone[0]);
  for (int round = 0; round < 2; ++round) {
    std::size_t met = 0;
    other->settle();
    EXPECT_TRUE(other->is_settled());
    other->trace(queries);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(world->intersect(rays[i], alone[i]), queries[i].met) << i;
      met += queries[i].met;
      if (!queries[i].met || !queries[i].hit) continue;
      EXPECT_EQ(alone[i].t, together[i].t) << i;
      EXPECT_EQ(alone[i].position, together[i].position) << i;
      EXPECT_EQ(alone[i].level, together[i].level) << i;
    }
    EXPECT_GT(met, 100u);
    EXPECT_LT(met, rays.size() - 100);
  }
}

TEST_F(ClassWorldsTest, OneFootprintIsOneWorld) {
  const auto model = bumpy_model(shapes::cube(), 5, 0.1, {64, 64});
  const auto footprint = footprint_of(0.02);
  const auto expanded = [&](const WorldOptions& options) {
    return world_of(model, options)->statistics().cells_expanded;
  };
  const auto one = expanded({.mode = ExpandMode::Eager, .footprint = footprint});
  EXPECT_EQ(expanded({.mode = ExpandMode::Eager, .footprint = footprint, .diffuse_footprint = footprint}), one);
  EXPECT_GT(expanded({.mode = ExpandMode::Eager, .footprint = footprint, .diffuse_footprint = footprint_of(0.05)}),
            one);
}

}  // namespace
}  // namespace meristem
