// Rays that wait for cells find what rays find that expand at once: ray by ray, since an image may hide a lost hit.
#include "geometry/accel/world.h"
#include "geometry/base/parallel.h"
#include "tests/support/point_footprint.h"
#include "tests/support/test_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace meristem {
namespace {

std::shared_ptr<const Part> part_of(std::shared_ptr<const Model> model) {
  return std::make_shared<const Part>(std::move(model));
}

// Groups of individuals of one model, turned and nested twice, at mixed levels of detail.
std::vector<Placement> nested_objects(const CellSettings& cells) {
  const auto cube = part_of(bumpy_model(shapes::cube(), 4, 0.2, cells));
  const auto pair = std::make_shared<const Part>(
      std::vector<Placement>{{cube, Affine3d::translation({-1, 0, 0}), 3, false},
                             {cube, Affine3d::translation({1, 0.2, 0}) * Affine3d::rotation({0, 1, 0}, 0.4), 4, true}});
  const auto four = std::make_shared<const Part>(
      std::vector<Placement>{{pair, Affine3d::rotation({0, 0, 1}, 0.3), 0, true},
                             {pair, Affine3d::translation({0, 2, 0}) * Affine3d::scaling({1, 0.8, 1.2}), 9, false}});
  return std::vector<Placement>{{four, Affine3d(), 0, true}, {four, Affine3d::translation({0.5, -3, 0}), 5, false}};
}

// From outside and inside, most of them through several cells; some end before they meet anything. Of all classes.
Ray ray_of(int i) {
  const auto random = [i](int what) { return 2 * uniform_float(hash_keys(Key(i), Key(what))) - 1; };
  const Vec3f from{4 * random(1), 5 * random(2), 4 * random(3)}, to{2 * random(4), 4 * random(5) - 1, random(6)};
  Ray ray{from, to - from};
  if (i % 3 == 0) ray.t_max = 0.8f + random(7) * 0.5f;
  ray.origin_class = RayClass(i % 7 % ray_classes);
  ray.ray_class = RayClass(i % 5 % ray_classes);
  return ray;
}

struct Found {
  bool met = false;
  float t = 0, u = 0, v = 0;
  Vec3f position = {}, normal = {};
  int object = -1;
  Key face = 0;
  bool operator==(const Found&) const = default;
};

Found found(bool met, const SurfaceHit& hit) {
  if (!met) return {};
  return {true, hit.t, hit.u, hit.v, hit.position, hit.shading_normal, hit.object, hit.origin.key};
}

// All rays at once, by queues: each waits until its cell comes up.
std::vector<Found> search_all(const Intersector& world, int first, int end, bool any) {
  std::vector<Found> result(std::size_t(end - first));
  std::vector<RaySearch> searches(result.size());
  std::map<Key, std::vector<int>> waiting;
  const auto go_on = [&](int i) {
    SurfaceHit hit;
    RaySearch& search = searches[std::size_t(i - first)];
    const RaySearch::End end_of_search = world.search(ray_of(i), any, search, hit);
    if (end_of_search == RaySearch::End::Waits)
      waiting[*search.waits_for()].push_back(i);
    else
      result[std::size_t(i - first)] =
          any ? Found{.met = end_of_search == RaySearch::End::Met} : found(end_of_search == RaySearch::End::Met, hit);
  };
  for (int i = first; i < end; ++i) go_on(i);
  while (!waiting.empty()) {
    const auto longest = std::ranges::max_element(waiting, {}, [](const auto& queue) { return queue.second.size(); });
    const std::vector<int> served = std::move(longest->second);
    const Key name = longest->first;
    waiting.erase(longest);
    for (const int i : served) {
      searches[std::size_t(i - first)].wake(name);
      go_on(i);
    }
  }
  return result;
}

struct Way {
  CellSettings cells;
  double budget;  // of all bytes
  int threads;
  bool scratch = false;
};

// 136,000 rays in all.
TEST(RaySearch, FindsTheSameHitsRayByRay) {
  constexpr int count = 34000;
  const auto footprint = std::make_shared<const PointFootprint>(Vec3d(6, 0, 0), 0.02),
             coarse = std::make_shared<const PointFootprint>(Vec3d(6, 0, 0), 0.05);
  int first = 0;
  for (const Way& way :
       {Way{{64, 64}, 1 / 16., 1}, Way{{16, 256}, 1 / 4., 8}, Way{{256, 64}, 2, 2}, Way{{64, 64}, 1 / 8., 2, true}}) {
    const auto objects = nested_objects(way.cells);
    const auto eager =
        make_world(objects, {.mode = ExpandMode::Eager, .footprint = footprint, .diffuse_footprint = coarse});
    std::vector<Found> expected(count);
    for (int i = 0; i < count; ++i) {
      SurfaceHit hit;
      expected[std::size_t(i)] = found(eager->intersect(ray_of(first + i), hit), hit);
    }
    EXPECT_GT(std::ranges::count_if(expected, &Found::met), count / 3);
    const auto budget = std::size_t(way.budget * double(eager->statistics().resident_bytes_peak));
    const auto world = make_world(objects, {.budget_bytes = budget,
                                            .footprint = footprint,
                                            .diffuse_footprint = coarse,
                                            .scratch_directory = way.scratch ? testing::TempDir() : ""});
    run_threads(way.threads, [&](int t) {
      const int begin = count / way.threads * t, end = count / way.threads * (t + 1);
      const bool any = t % 2 == 1;  // both kinds, side by side
      std::vector<Found> wanted(expected.begin() + begin, expected.begin() + end);
      if (any)
        for (Found& f : wanted) f = {.met = f.met};
      EXPECT_TRUE(search_all(*world, first + begin, first + end, any) == wanted)
          << way.threads << " threads, " << budget << " bytes, any hit: " << any;
    });
    EXPECT_TRUE(world->statistics().defects.empty());
    EXPECT_EQ(world->statistics().reexpanded > 0, way.budget < 1);
    EXPECT_EQ(world->statistics().read_back > 0, way.scratch);
    first += count;
  }
}

// A cell that was never expanded is expanded at once; for one that has been forgotten a ray waits.
TEST(RaySearch, WaitsForWhatHasBeenForgotten) {
  const auto part = part_of(bumpy_model(shapes::prism(8), 6, 0.1, {64, 64}));
  const auto eager = make_world({{part, Affine3d(), 0, true}}, {.mode = ExpandMode::Eager});
  const auto world =
      make_world({{part, Affine3d(), 0, true}}, {.budget_bytes = eager->statistics().resident_bytes_peak / 12});
  int waits = 0;
  constexpr int count = 500;
  for (int i = 0; i < 2 * count; ++i) {
    const Ray ray = ray_of(i % count);
    RaySearch search;
    SurfaceHit hit, expected;
    std::uint64_t before = world->statistics().cells_expanded;
    RaySearch::End end = world->search(ray, false, search, hit);
    EXPECT_TRUE(i > 0 || end != RaySearch::End::Waits);
    for (; end == RaySearch::End::Waits; ++waits) {
      ASSERT_TRUE(search.waits_for());
      end = world->search(ray, false, search, hit);
      EXPECT_TRUE(i < count || world->statistics().cells_expanded > before);
      before = world->statistics().cells_expanded;
    }
    const bool met = eager->intersect(ray, expected);
    EXPECT_EQ(end, met ? RaySearch::End::Met : RaySearch::End::Missed);
    EXPECT_EQ(found(met, hit), found(met, expected));
  }
  EXPECT_GT(waits, count / 2);
}

// A ray along a row of boxes would have to wait for each of them; it expands at once instead.
TEST(RaySearch, ARayThatMissesTooMuchDoesNotWait) {
  const auto cube = part_of(bumpy_model(shapes::cube(), 2, 0.1, {64, 64}));
  std::vector<Placement> row;
  for (int i = 0; i < 1100; ++i) row.push_back({cube, Affine3d::translation({0, 0, -3.0 * i}), Key(i + 1), false});
  const auto world = make_world(row, {}), plain = make_world(row, {});
  for (const float x : {0.1f, 0.98f}) {
    RaySearch search;
    SurfaceHit hit, expected;
    const Ray ray{{x, 0.97f, 6}, {0, 0, -1}};
    const bool met = plain->intersect(ray, expected);
    EXPECT_EQ(world->search(ray, false, search, hit), met ? RaySearch::End::Met : RaySearch::End::Missed);
    EXPECT_EQ(found(met, hit), found(met, expected));
  }
}

}  // namespace
}  // namespace meristem
