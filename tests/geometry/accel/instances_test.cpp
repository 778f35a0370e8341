#include "geometry/accel/instances.h"
#include "geometry/accel/tracing.h"
#include "geometry/accel/world.h"
#include "tests/support/point_footprint.h"
#include "tests/support/test_model.h"

#include <gtest/gtest.h>

#include <tuple>

namespace meristem {
namespace {

std::shared_ptr<const Part> part_of(std::shared_ptr<const Model> model) {
  return std::make_shared<const Part>(std::move(model));
}

std::shared_ptr<const Part> group_of(std::vector<Placement> members) {
  return std::make_shared<const Part>(std::move(members));
}

const CellSettings small_cells{64, 64};

auto bits_of(const SurfaceHit& hit) {
  return std::tuple(hit.t, hit.position.x, hit.position.y, hit.position.z, hit.shading_normal.x, hit.u, hit.object,
                    hit.origin.key);
}

Ray towards_origin(Key key) {
  const double a = 2 * pi * uniform_double(hash_keys(key, 1)), y = 2 * uniform_double(hash_keys(key, 2)) - 1;
  const Vec3f from{float(6 * std::cos(a)), float(3 * y), float(6 * std::sin(a))};
  return {from, normalize(Vec3f(0) - from)};
}

// Groups in groups give what one placement by the product of their transforms gives.
TEST(Instances, NestAsDeepAsWished) {
  const auto model = bumpy_model(shapes::cube(), 3, 0.2, small_cells);
  const Affine3d turn = Affine3d::rotation({0, 1, 0}, 0.3), move = Affine3d::translation({0.1, 0.2, 0}),
                 shrink = Affine3d::scaling({0.9, 1.1, 1});
  auto nested = part_of(model);
  Affine3d product;
  for (int depth = 0; depth < 4; ++depth)
    for (const Affine3d& m : {turn, move, shrink}) {
      nested = group_of({{nested, m, 0, true}});
      product = m * product;
    }
  const auto deep = make_world({{nested, {}, 0, true}}, {}),
             flat = make_world({{part_of(model), product, 0, true}}, {});
  int hits = 0;
  for (int i = 0; i < 500; ++i) {
    SurfaceHit a, b;
    const bool found = deep->intersect(towards_origin(Key(i)), a);
    if (found != flat->intersect(towards_origin(Key(i)), b)) continue;  // grazing rays may differ by rounding
    if (!found) continue;
    ++hits;
    EXPECT_NEAR(a.t, b.t, 1e-4f);
    EXPECT_LT(length(a.position - b.position), 1e-4f);
    EXPECT_LT(length(a.position - (towards_origin(Key(i)).origin + towards_origin(Key(i)).direction * a.t)),
              length(a.position_error) + 2e-5f);
  }
  EXPECT_GT(hits, 300);
}

// Distinct individuals differ, those with one key do not.
TEST(Instances, IndividualsDifferByTheirKeys) {
  const auto part = part_of(bumpy_model(shapes::cube(), 3, 0.2, small_cells));
  const auto world = make_world({{part, {}, 1, true},
                                 {part, Affine3d::translation({100, 0, 0}), 1, true},
                                 {part, Affine3d::translation({200, 0, 0}), 2, false}},
                                {});
  int same = 0, different = 0;
  for (int i = 0; i < 100; ++i) {
    Ray ray = towards_origin(Key(i));
    SurfaceHit a, b, c;
    world->intersect(ray, a);
    ray.origin.x += 100;
    world->intersect(ray, b);
    ray.origin.x += 100;
    world->intersect(ray, c);
    same += std::abs(a.t - b.t) < 1e-4f;
    different += std::abs(a.t - c.t) > 1e-4f;
  }
  EXPECT_EQ(same, 100);
  EXPECT_GT(different, 80);
}

// Far placements of one individual share what is expanded; near ones have their own level of detail.
TEST(Instances, DistantOnesShareCells) {
  const auto part = part_of(bumpy_model(shapes::cube(), 4, 0.2, small_cells));
  std::vector<Placement> row;
  for (int i = 0; i < 50; ++i) row.push_back({part, Affine3d::translation({1000.0 + i, 0, 3.0 * i}), 0, true});
  const auto world = make_world(row, {.footprint = std::make_shared<const PointFootprint>(Vec3d(0), 1e-3)});
  SurfaceHit hit;
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(world->intersect({{900, 0.1f, 3.0f * float(i)}, {1, 0, 0}}, hit));
  EXPECT_LT(world->statistics().cells_expanded, 8u);
}

TEST(Instances, LazyAndEagerGiveTheSameBits) {
  const auto cube = part_of(bumpy_model(shapes::cube(), 4, 0.2, small_cells));
  const auto pair = group_of(
      {{cube, Affine3d::translation({-1, 0, 0}), 3, false}, {cube, Affine3d::translation({1, 0, 0}), 4, false}});
  const std::vector<Placement> objects{{pair, {}, 0, true}, {pair, Affine3d::translation({0, 2.5, 0}), 9, false}};
  const auto footprint = std::make_shared<const PointFootprint>(Vec3d(6, 0, 0), 0.02);
  const auto eager = make_world(objects, {.mode = ExpandMode::Eager, .footprint = footprint}),
             lazy = make_world(objects, {.budget_bytes = 100 << 10, .footprint = footprint});
  for (int i = 0; i < 2000; ++i) {
    SurfaceHit a, b;
    EXPECT_EQ(eager->intersect(towards_origin(Key(i)), a), lazy->intersect(towards_origin(Key(i)), b));
    EXPECT_EQ(a.t, b.t);
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.u, b.u);
  }
  EXPECT_GT(lazy->statistics().reexpanded, 0u);
  EXPECT_TRUE(lazy->statistics().defects.empty());
}

// Where cells of different levels meet, inside and outside stay apart.
TEST(Instances, NoRayEscapesThroughMixedDetail) {
  const auto part = part_of(bumpy_model(shapes::prism(8), 7, 0.2, small_cells));
  const auto footprint = std::make_shared<const PointFootprint>(Vec3d(1.3, 1, 0), 0.02);
  const auto world = make_world({{part, {}, 0, true}}, {.footprint = footprint});
  int escaped = 0;
  for (int i = 0; i < 200000; ++i) {
    const double z = 1 - 2 * uniform_double(hash_keys(Key(i), 1)), a = 2 * pi * uniform_double(hash_keys(Key(i), 2)),
                 s = std::sqrt(1 - z * z);
    escaped += !world->occluded({{0, 1, 0}, {float(s * std::cos(a)), float(s * std::sin(a)), float(z)}});
  }
  EXPECT_EQ(escaped, 0);
  EXPECT_TRUE(world->statistics().defects.empty());
}

// What rays come to, in wide bounds until more is known.
class WideRoot : public ModelRoot {
 public:
  WideRoot() : ModelRoot({Vec3f(-8), Vec3f(8)}) {}
  void intersect(RayContext&, RTCRayHit&) const override { ++rays; }
  void occluded(RayContext&, RTCRay&) const override { ++rays; }
  Bounds3f known_bounds() const override { return known; }
  std::size_t bytes() const override { return sizeof(*this); }

  Bounds3f known = bounds();
  mutable int rays = 0;
};

// How many roots a ray along z comes to.
int rays_at(const Instances& instances, const WideRoot& root, float x, float y) {
  const int before = root.rays;
  Tracing tracing({{x, y, -100}, {0, 0, 1}}, nullptr);
  instances.intersect(tracing.context, tracing.query);
  return root.rays - before;
}

// A root in each of these places.
std::unique_ptr<Instances> placed(const WideRoot& root, const std::vector<Placement>& places) {
  const ModelRoot* const roots[] = {&root};
  std::vector<Instance> instances;
  std::vector<Bounds3f> bounds;
  for (const Placement& p : places) {
    instances.emplace_back(roots, p);
    bounds.push_back(instance_bounds(roots, p));
  }
  return std::make_unique<Instances>(std::move(instances), bounds, std::vector<std::unique_ptr<ModelRoot>>{}, true, 0);
}

TEST(Instances, AreEnteredWhereTheirRootsAreKnownToBe) {
  WideRoot root;
  const auto pair = placed(
      root,
      {{.part = nullptr, .to_parent = {}},
       {.part = nullptr, .to_parent = Affine3d::translation({20, 0, 0}) * Affine3d::rotation({0, 0, 1}, pi / 2)}});
  Instances& instances = *pair;
  root.known = {{2, -1, -1}, {4, 1, 1}};
  EXPECT_EQ(rays_at(instances, root, 0, 0), 1) << "as they were placed";
  instances.tighten();
  EXPECT_EQ(rays_at(instances, root, 0, 0), 0);
  EXPECT_EQ(rays_at(instances, root, 3, 0), 1);
  EXPECT_EQ(rays_at(instances, root, 20, 3), 1) << "turned";
  EXPECT_EQ(rays_at(instances, root, 23, 0), 0);
  EXPECT_EQ(instances.bounds().upper.x, 28) << "what depends on the size of all does not change";
  root.known = {{2, -1, -1}, {3.5f, 1, 1}};
  instances.tighten();
  EXPECT_EQ(rays_at(instances, root, 3.7f, 0), 0) << "once more";
}

TEST(Instances, WhatMovesIsEnteredWhereverItMayBe) {
  WideRoot root;
  const std::vector<Affine3d> keys{{}, Affine3d::translation({40, 0, 0})};
  const auto pair = placed(root, {{.part = nullptr, .to_parent = {}, .motion = std::make_shared<const Motion>(keys)},
                                  {.part = nullptr, .to_parent = Affine3d::translation({0, 50, 0})}});
  Instances& instances = *pair;
  root.known = {Vec3f(-1), Vec3f(1)};
  instances.tighten();
  for (const float x : {0.f, 20.f, 40.f}) EXPECT_EQ(rays_at(instances, root, x, 0), 1) << x;
  EXPECT_EQ(rays_at(instances, root, 20, 3), 0);
}

// Groups in groups, turned, with what is far larger before it is known; by rays one by one and together.
TEST(Instances, SettledGroupsGiveTheSameBits) {
  const auto cube = part_of(bumpy_model(shapes::cube(), 4, 0.2, small_cells));
  const auto pair = group_of({{cube, Affine3d::translation({-1, 0, 0}), 3, false},
                              {cube, Affine3d::rotation({0, 0, 1}, 0.7) * Affine3d::translation({1, 0, 0}), 4, false}});
  const auto pairs = group_of({{pair, {}, 0, true}, {pair, Affine3d::translation({0, 2.5, 0}), 9, false}});
  const std::vector<Placement> objects{{pairs, Affine3d::rotation({1, 0, 0}, 0.4), 0, true},
                                       {pair, Affine3d::translation({0, -2.5, 0}), 11, false}};
  const auto plain = make_world(objects, {}), settling = make_world(objects, {});
  int hits = 0;
  for (int round = 0; round < 3; ++round) {
    std::vector<Ray> rays;
    for (int i = 0; i < 1000; ++i) rays.push_back(towards_origin(Key(round == 2 ? i / 8 : i)));  // at last packets
    std::vector<SurfaceHit> together(rays.size());
    std::vector<RayQuery> queries;
    for (std::size_t i = 0; i < rays.size(); ++i) queries.push_back({&rays[i], i % 5 == 0 ? nullptr : &together[i]});
    settling->trace(queries, round == 2);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      SurfaceHit a, b;
      const bool met = plain->intersect(rays[i], a);
      ASSERT_EQ(met, settling->intersect(rays[i], b)) << i;
      ASSERT_EQ(met, queries[i].met) << i;
      hits += met;
      EXPECT_EQ(bits_of(a), bits_of(b));
      EXPECT_TRUE(!queries[i].hit || bits_of(a) == bits_of(together[i])) << i;
    }
    settling->settle();
    EXPECT_TRUE(settling->is_settled());
  }
  EXPECT_GT(hits, 500);
}

// More objects than a list holds, more than are a tree of ours without settling, of one cell and of many.
TEST(Instances, ManyObjectsGiveTheSameBitsTogether) {
  const auto small = part_of(bumpy_model(shapes::cube(), 2, 0.2, {})),
             large = part_of(bumpy_model(shapes::cube(), 4, 0.2, small_cells));
  for (const int count : {40, 1100}) {
    std::vector<Placement> objects;
    for (int i = 0; i < count; ++i) {
      const auto random = [i](Key what) { return 4 * uniform_double(hash_keys(Key(i), what)) - 2; };
      objects.push_back({i % 10 == 0 ? large : small,
                         Affine3d::translation({random(1), random(2), random(3)}) * Affine3d::scaling(Vec3d(0.2)) *
                             Affine3d::rotation({0, 1, 0}, random(4)),
                         Key(i % 3), true});
    }
    const auto world = make_world(objects, {});
    for (int round = 0; round < 3; ++round) {
      std::vector<Ray> rays;
      for (int i = 0; i < 600; ++i) rays.push_back(towards_origin(Key(round == 2 ? i / 8 : i)));  // at last packets
      std::vector<SurfaceHit> together(rays.size());
      std::vector<RayQuery> queries;
      for (std::size_t i = 0; i < rays.size(); ++i) queries.push_back({&rays[i], i % 5 == 0 ? nullptr : &together[i]});
      world->trace(queries, round == 2);
      int hits = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        SurfaceHit alone;
        ASSERT_EQ(world->intersect(rays[i], alone), queries[i].met) << i;
        hits += queries[i].met;
        EXPECT_TRUE(!queries[i].hit || bits_of(alone) == bits_of(together[i])) << i;
      }
      EXPECT_GT(hits, 100);
      world->settle();
      EXPECT_TRUE(world->is_settled());
    }
  }
}

}  // namespace
}  // namespace meristem
