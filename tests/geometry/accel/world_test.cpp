#include "geometry/accel/world.h"

#include "geometry/base/parallel.h"
#include "tests/support/point_footprint.h"
#include "tests/support/shown_corners.h"
#include "tests/support/test_model.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <atomic>
#include <cstring>

namespace meristem {
namespace {

Vec3f direction(Key key) {
  const double z = 1 - 2 * uniform_double(hash_keys(key, 1)), a = 2 * pi * uniform_double(hash_keys(key, 2)),
               s = std::sqrt(1 - z * z);
  return {float(s * std::cos(a)), float(s * std::sin(a)), float(z)};
}

// Rays from a sphere around the model towards points near its middle.
Ray ray_towards(Key key) {
  const Vec3f from = direction(hash_keys(key, 3)) * 6.0f + Vec3f{0, 1, 0};
  const Vec3f to = direction(hash_keys(key, 4)) * 1.2f * uniform_float(hash_keys(key, 5)) + Vec3f{0, 1, 0};
  return Ray{from, normalize(to - from)};
}

Placement place(std::shared_ptr<const Model> model, const Affine3d& to_world = {}) {
  return {std::make_shared<const Part>(std::move(model)), to_world, 0, true};
}

std::unique_ptr<Intersector> world_of(std::shared_ptr<const Model> model, const WorldOptions& options) {
  return make_world({place(std::move(model))}, options);
}

std::uint64_t bits_of(const SurfaceHit& hit) {
  Key h = 0;
  for (float x : {hit.t, hit.position.x, hit.position.y, hit.position.z, hit.geometric_normal.x, hit.geometric_normal.y,
                  hit.geometric_normal.z, hit.shading_normal.x, hit.u, hit.v}) {
    std::uint32_t bits;
    std::memcpy(&bits, &x, 4);
    h = hash_keys(h, bits);
  }
  return hash_keys(h, hit.origin.key);
}

struct Traced {
  std::vector<std::uint64_t> hits;
  ExpansionStatistics statistics;
};

Traced trace(const std::shared_ptr<const Model>& model, const WorldOptions& options, int threads, int count) {
  const auto world = world_of(model, options);
  Traced result;
  result.hits.resize(std::size_t(count));
  std::atomic<int> next{0};
  run_threads(threads, [&](int) {
    for (int begin; (begin = next.fetch_add(16)) < count;)
      for (int i = begin; i < std::min(count, begin + 16); ++i) {
        SurfaceHit hit;
        const bool found = world->intersect(ray_towards(Key(i)), hit);
        result.hits[std::size_t(i)] = found ? bits_of(hit) : 0;
        EXPECT_EQ(world->occluded(ray_towards(Key(i))), found);
      }
  });
  result.statistics = world->statistics();
  return result;
}

const CellSettings small_cells{64, 64};

std::size_t least_bytes(const std::shared_ptr<const Model>& model, int threads) {
  return least_budget({place(model)}, {.budget_bytes = 1, .threads = threads});
}

TEST(World, LazyAndEagerGiveTheSameBitsForAnyThreadsAndBudget) {
  const auto model = bumpy_model(shapes::prism(8), 6, 0.1, small_cells);
  constexpr int rays = 256;  // enough that the smaller budgets evict and expand again
  const Traced eager = trace(model, {.mode = ExpandMode::Eager}, 1, rays);
  EXPECT_EQ(eager.statistics.evicted, 0u);
  const std::size_t all = eager.statistics.resident_bytes_peak;
  for (int threads : {1, 2, 8}) {
    const std::size_t least = least_bytes(model, threads);
    for (std::size_t budget : {least, std::max(least, all / 16), all / 4, std::size_t(1) << 40}) {
      const Traced lazy = trace(model, {.mode = ExpandMode::Lazy, .budget_bytes = budget}, threads, rays);
      EXPECT_TRUE(lazy.hits == eager.hits) << threads << " threads, " << budget << " bytes";
      EXPECT_TRUE(lazy.statistics.defects.empty());
      EXPECT_EQ(lazy.statistics.reexpanded > 0, budget < all / 2);
      // Resident, in limbo, plans and roots together: beyond the budget only the cells in flight
      EXPECT_LE(lazy.statistics.total_bytes_peak, budget + least) << threads << " threads";
    }
  }
}

Ray any_ray(int i) { return ray_towards(Key(i)); }
// A dozen are like those of a pixel.
Ray ray_of_pixel(int i) {
  Ray ray = ray_towards(Key(i / 12));
  for (const int axis : {0, 1, 2})
    (&ray.direction.x)[axis] += 0.01f * (uniform_float(hash_keys(Key(i), Key(axis))) - 0.5f) * length(ray.direction);
  return ray;
}

// Of rays from `first` up to `last`, with what each finds. Any number of objects.
std::vector<std::uint64_t> hits_of(const Intersector& world, int first, int last, Ray (*ray_of)(int) = any_ray) {
  std::vector<std::uint64_t> hits;
  for (int i = first; i < last; ++i) {
    SurfaceHit hit;
    const bool found = world.intersect(ray_of(i), hit);
    hits.push_back(found ? hash_keys(bits_of(hit), Key(hit.object)) : 0);
    EXPECT_EQ(world.occluded(ray_of(i)), found);
  }
  return hits;
}

// The same of rays that are traced together, some dozens at once; every third only asks whether it meets anything.
std::vector<std::uint64_t> hits_together(const Intersector& world, int first, int last, Ray (*ray_of)(int) = any_ray) {
  std::vector<std::uint64_t> hits;
  for (int begin = first; begin < last; begin += 48) {
    std::vector<Ray> rays;
    for (int i = begin; i < std::min(begin + 48, last); ++i) rays.push_back(ray_of(i));
    std::vector<SurfaceHit> of_rays(rays.size());
    std::vector<RayQuery> queries;
    for (std::size_t i = 0; i < rays.size(); ++i) queries.push_back({&rays[i], i % 3 == 0 ? nullptr : &of_rays[i]});
    world.trace(queries, ray_of == ray_of_pixel);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (queries[i].met && !queries[i].hit) world.intersect(rays[i], of_rays[i]);
      hits.push_back(queries[i].met ? hash_keys(bits_of(of_rays[i]), Key(of_rays[i].object)) : 0);
    }
  }
  return hits;
}

TEST(World, RaysMeetTheSameWhereItHasSettled) {
  const auto model = bumpy_model(shapes::prism(8), 6, 0.1, small_cells);
  const std::vector<Placement> objects{place(model), place(model, Affine3d::rotation({0, 1, 0}, 0.3)),
                                       place(bumpy_model(shapes::cube(), 2, 0.3, {}))};
  const auto plain = make_world(objects, {}), settling = make_world(objects, {});
  for (int first : {0, 64, 512}) {  // more is expanded between, and beside what has settled
    EXPECT_EQ(hits_together(*settling, first, 1024), hits_of(*plain, first, 1024));
    EXPECT_EQ(hits_of(*settling, first, 1024), hits_of(*plain, first, 1024));
    EXPECT_EQ(hits_together(*settling, first, 1024, ray_of_pixel), hits_of(*plain, first, 1024, ray_of_pixel));
    settling->settle();
    EXPECT_TRUE(settling->is_settled());
    EXPECT_GT(settling->statistics().total_bytes_peak, plain->statistics().total_bytes_peak) << "braids count";
  }
  settling->unsettle();
  EXPECT_FALSE(settling->is_settled());
  EXPECT_EQ(hits_of(*settling, 0, 512), hits_of(*plain, 0, 512));
  // Boxes come in another order, so other rays meet first what spares a cell its expansion
  EXPECT_NEAR(double(settling->statistics().cells_expanded), double(plain->statistics().cells_expanded), 8);
}

TEST(World, WhatHasSettledStaysUntilItIsInTheWay) {
  const auto model = bumpy_model(shapes::prism(8), 6, 0.1, small_cells);
  const std::vector<std::uint64_t> all = hits_of(*world_of(model, {}), 0, 256);
  std::size_t of_few;
  {
    const auto world = world_of(model, {});
    hits_of(*world, 0, 8);
    of_few = world->statistics().total_bytes_peak;
  }
  const auto world = world_of(model, {.budget_bytes = of_few * 3 / 2});
  hits_of(*world, 0, 8);
  world->settle();
  const std::uint64_t expanded = world->statistics().cells_expanded;
  hits_of(*world, 0, 8);
  EXPECT_LE(world->statistics().cells_expanded, expanded + 8);
  EXPECT_FALSE(world->is_crowded());
  EXPECT_EQ(hits_together(*world, 0, 256), all);  // while some wait others evict what they have met
  EXPECT_EQ(hits_of(*world, 0, 256), all);
  EXPECT_TRUE(world->is_crowded());
  const std::uint64_t crowded = world->statistics().cells_expanded;
  hits_of(*world, 0, 8);
  EXPECT_LE(world->statistics().cells_expanded, crowded + 8) << "it has stayed";
  world->settle();
  EXPECT_FALSE(world->is_crowded()) << "it has let go";
  EXPECT_EQ(hits_of(*world, 0, 256), all);
  EXPECT_EQ(hits_of(*world, 0, 256), all);
  EXPECT_FALSE(world->is_crowded());
}

// What a ray of a stream has met outside of what has settled stays while others of the stream expand and evict cells.
TEST(World, RaysTracedTogetherHoldWhatTheyHaveMet) {
  mallopt(M_PERTURB, 0xa5);  // memory that is given back is overwritten
  const auto model = bumpy_model(shapes::prism(8), 6, 0.1, small_cells);
  const std::vector<std::uint64_t> all = hits_of(*world_of(model, {}), 0, 512),
                                   near = hits_of(*world_of(model, {}), 0, 512, ray_of_pixel);
  std::size_t of_one;
  {
    const auto world = world_of(model, {});
    hits_of(*world, 0, 1);
    of_one = world->statistics().total_bytes_peak;
  }
  for (const double room : {1.34, 1.4, 1.5}) {
    const auto world = world_of(model, {.budget_bytes = std::size_t(double(of_one) * room)});
    hits_of(*world, 0, 1);
    world->settle();
    EXPECT_TRUE(world->is_settled());
    EXPECT_EQ(hits_together(*world, 0, 512), all) << room;
    EXPECT_EQ(hits_together(*world, 0, 512, ray_of_pixel), near) << room;
    EXPECT_GT(world->statistics().reexpanded, 100u);
  }
  mallopt(M_PERTURB, 0);
}

TEST(World, RaysTracedTogetherTellWhatEachExpanded) {
  const auto world = world_of(bumpy_model(shapes::prism(8), 6, 0.1, small_cells), {});
  constexpr int known = 64, all = 512;
  hits_of(*world, 0, known);
  world->settle();
  const std::uint64_t before = world->statistics().cells_expanded;
  const auto looks_away = [](std::size_t i) { return i % 4 == 1; };
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < all; ++i) {
    rays.push_back(ray_towards(Key(known + i)));
    if (looks_away(i)) rays[i].direction = -rays[i].direction;
  }
  std::vector<SurfaceHit> hits(all);
  std::vector<ThreadExpansions> of_rays(all);
  std::vector<RayQuery> queries;
  for (std::size_t i = 0; i < all; ++i)
    queries.push_back({.ray = &rays[i], .hit = i % 3 == 0 ? nullptr : &hits[i], .expansions = &of_rays[i]});
  world->trace(queries);
  ThreadExpansions sum;
  for (std::size_t i = 0; i < all; ++i) {
    EXPECT_EQ(of_rays[i].expanded > 0, of_rays[i].nanoseconds > 0);
    EXPECT_FALSE(of_rays[i].expanded > 0 && looks_away(i)) << i;
    sum += of_rays[i];
  }
  EXPECT_GT(sum.expanded, 100u);
  EXPECT_EQ(sum.expanded, world->statistics().cells_expanded - before);
}

TEST(World, TheLeastBudgetIsAChainOfCellsForEachThread) {
  const auto model = bumpy_model(shapes::prism(8), 5, 0.1, small_cells);
  const std::size_t one = least_bytes(model, 1), eight = least_bytes(model, 8);
  EXPECT_GT(one, 10000u);
  EXPECT_LT(one, trace(model, {.mode = ExpandMode::Eager}, 1, 1).statistics.resident_bytes_peak / 4);
  EXPECT_NEAR(double(eight) / double(one), 8, 0.5);
  EXPECT_EQ(least_budget({place(model)}, {.budget_bytes = std::size_t(1) << 40, .threads = 8}), 0u) << "ample";
  EXPECT_EQ(least_budget({place(model)}, {.mode = ExpandMode::Eager, .budget_bytes = 1}), 0u);
}

// How fine the surface is where it was met.
TEST(World, HitsKnowTheLevelOfTheirFaces) {
  constexpr int levels = 7;
  const auto model = bumpy_model(shapes::cube(), levels, 0, small_cells);
  const auto mean_level = [&](double pixel) {
    WorldOptions options;
    if (pixel > 0) options.footprint = std::make_shared<PointFootprint>(Vec3d{6, 1, 0}, pixel);
    const auto world = world_of(model, options);
    double sum = 0;
    int hits = 0;
    for (int i = 0; i < 1000; ++i) {
      SurfaceHit hit;
      if (!world->intersect(ray_towards(Key(i)), hit)) continue;
      EXPECT_TRUE(hit.level >= 1 && hit.level <= levels);
      sum += hit.level;
      ++hits;
    }
    return sum / hits;
  };
  EXPECT_EQ(mean_level(0), levels) << "everything in full";
  const double fine = mean_level(0.005), coarse = mean_level(0.01);
  EXPECT_LT(fine, levels);
  EXPECT_NEAR(fine - coarse, 1, 0.2) << "faces twice as large: one level less";
}

TEST(World, LazyExpandsOnlyWhatRaysEnter) {
  const auto model = bumpy_model(shapes::prism(8), 6, 0.1, small_cells);
  const auto lazy = world_of(model, {});
  EXPECT_EQ(lazy->statistics().cells_expanded, 0u);
  SurfaceHit hit;
  EXPECT_TRUE(lazy->intersect(ray_towards(1), hit));
  const auto eager = world_of(model, {.mode = ExpandMode::Eager});
  EXPECT_LT(lazy->statistics().cells_expanded, eager->statistics().cells_expanded / 4);
  EXPECT_GT(eager->statistics().cells_expanded, 200u);
}

// A ray that anything may stop looks at what is resident first.
TEST(World, WhatIsResidentSparesAShadowTheExpansionOfOthers) {
  const auto model = bumpy_model(shapes::prism(8), 6, 0.1, small_cells);
  const auto seen = world_of(model, {});
  std::vector<Ray> hits;
  for (int i = 0; i < 400; ++i)
    if (SurfaceHit hit; seen->intersect(ray_towards(Key(i)), hit)) hits.push_back(ray_towards(Key(i)));
  const std::uint64_t expanded = seen->statistics().cells_expanded;
  for (const Ray& ray : hits) EXPECT_TRUE(seen->occluded(ray));
  // From the other side: what the first ray met is in the way
  for (const Ray& ray : hits) EXPECT_TRUE(seen->occluded({ray.origin + ray.direction * 12.f, -ray.direction}));
  EXPECT_EQ(seen->statistics().cells_expanded, expanded);
}

// Towards vertices of the mesh before its last refinements, which lie on borders of cells: two triangles and more are
// at one distance there.
std::vector<Ray> rays_at_borders(const Model& model) {
  std::vector<Ray> rays;
  for (const auto& corners : shown_corners(model, nullptr))
    for (const auto& c : corners) {
      const Vec3f to{c[0], c[1], c[2]}, from = to * 4.f + Vec3f{0.25f, 1, 0.5f};
      rays.push_back({from, normalize(to - from)});
    }
  return rays;
}

// Bit for bit, also of rays that pass through vertices and edges.
TEST(World, RaysMeetTheSameHoweverAModelIsCut) {
  const auto cut = [](const CellSettings& settings) { return bumpy_model(shapes::prism(5), 4, 0.2, settings); };
  const std::vector<Ray> rays = rays_at_borders(*cut({}));
  const auto flat = world_of(cut(small_cells), {.mode = ExpandMode::Flat});
  std::vector<std::uint64_t> expected;
  for (const Ray& ray : rays) {
    SurfaceHit hit;
    expected.push_back(flat->intersect(ray, hit) ? bits_of(hit) : 0);
  }
  for (const CellSettings settings : {CellSettings{4, 16}, small_cells, CellSettings{256, 128}, CellSettings{}}) {
    const auto lazy = world_of(cut(settings), {});
    for (const bool has_settled : {false, true}) {
      std::size_t others = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        SurfaceHit hit;
        others += (lazy->intersect(rays[i], hit) ? bits_of(hit) : 0) != expected[i];
      }
      EXPECT_EQ(others, 0u) << "leaves of " << settings.leaf_faces << (has_settled ? ", settled" : "");
      lazy->settle();
    }
  }
}

TEST(World, HitIsOnTheRayAndNormalsPointOutwards) {
  const auto world = world_of(bumpy_model(shapes::cube(), 4, 0.05, small_cells), {});
  for (int i = 0; i < 1000; ++i) {
    const Ray ray = ray_towards(Key(i));
    SurfaceHit hit;
    if (!world->intersect(ray, hit)) continue;
    EXPECT_LT(length(ray.origin + ray.direction * hit.t - hit.position), 2e-5f);
    EXPECT_LT(dot(hit.geometric_normal, ray.direction), 0) << "seen from outside";
    EXPECT_GT(dot(hit.geometric_normal, hit.shading_normal), 0);
    EXPECT_LT(max_component(hit.position_error), 1e-4f);
  }
}

// From inside a closed model no ray gets out: random rays, and rays aimed exactly at vertices' neighbourhoods on cell
// borders.
TEST(World, NoRayEscapesFromInside) {
  const auto model = bumpy_model(shapes::prism(8), 5, 0.2, small_cells);
  const auto world = world_of(model, {.budget_bytes = std::size_t(1) << 40});
  int escaped = 0;
  for (int i = 0; i < 200000; ++i) escaped += !world->occluded({{0, 1, 0}, direction(Key(i))});
  EXPECT_EQ(escaped, 0);
}

TEST(World, TransformedObjectsMatchTransformedRays) {
  const auto model = bumpy_model(shapes::cube(), 4, 0.2, small_cells);
  const Affine3d to_world =
      Affine3d::translation({3, 1, -2}) * Affine3d::rotation({0, 1, 0}, 0.7) * Affine3d::scaling({1, 2, 0.5});
  const auto plain = world_of(model, {}),
             placed = make_world({place(model, to_world), place(model, Affine3d::translation({100, 0, 0}))}, {});
  const Affine3f m{Vec3f(to_world.x), Vec3f(to_world.y), Vec3f(to_world.z), Vec3f(to_world.origin)};
  int hits = 0;
  for (int i = 0; i < 1000; ++i) {
    const Ray ray = ray_towards(Key(i));
    SurfaceHit a, b;
    const bool found = plain->intersect(ray, a);
    if (found != placed->intersect({m.point(ray.origin), m.vector(ray.direction)}, b))
      continue;  // grazing rays may differ by rounding
    if (!found) continue;
    ++hits;
    EXPECT_NEAR(a.t, b.t, 1e-4f);
    EXPECT_LT(length(m.point(a.position) - b.position), 1e-3f);
    EXPECT_EQ(b.object, 0);
  }
  EXPECT_GT(hits, 300);
}

class FailingStep final : public Step {
 public:
  std::string name() const override { return "failing"; }
  int halo_rings(int r) const override { return r; }
  std::uint32_t max_children(std::uint32_t) const override { return 1; }
  void apply(const CellMesh&, int, CellMesh&) const override { throw std::runtime_error("on purpose"); }
  Extent bound(const Extent& e) const override { return e; }
};

TEST(World, ACellThatFailsIsItsBoxAndReported) {
  std::vector<std::unique_ptr<Step>> steps;
  steps.push_back(std::make_unique<FailingStep>());
  const auto world = world_of(std::make_shared<const Model>("broken", shapes::cube(), std::move(steps)), {});
  SurfaceHit hit;
  EXPECT_TRUE(world->intersect({{0, 0, 5}, {0, 0, -1}}, hit));
  EXPECT_NEAR(hit.t, 4, 1e-3);
  ASSERT_EQ(world->statistics().defects.size(), 1u);
  EXPECT_NE(world->statistics().defects[0].find("on purpose"), std::string::npos);
}

TEST(World, InvalidRaysHitNothingAndAreCounted) {
  const auto world = world_of(bumpy_model(shapes::cube(), 2, 0), {});
  SurfaceHit hit;
  EXPECT_FALSE(world->intersect({{0, 0, NAN}, {0, 0, 1}}, hit));
  EXPECT_FALSE(world->occluded({{0, 0, 0}, {0, 0, 0}}));
  EXPECT_EQ(world->statistics().invalid_rays, 2u);
  world->settle();
  const Ray good{{0, 0, 5}, {0, 0, -1}}, bad{{0, NAN, 0}, {0, 0, 1}};
  RayQuery queries[] = {{&good, &hit}, {&bad, nullptr}, {&good, nullptr}};
  world->trace(queries);
  EXPECT_TRUE(queries[0].met && !queries[1].met && queries[2].met);
  EXPECT_EQ(world->statistics().invalid_rays, 3u);
}

}  // namespace
}  // namespace meristem
