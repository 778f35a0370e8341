#include "geometry/tree/surface_tree.h"

#include "geometry/base/key.h"
#include "geometry/base/parallel.h"
#include "geometry/cells/surface_vertices.h"
#include "geometry/tree/tree_builder.h"
#include "geometry/tree/tree_kernels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

using namespace meristem;

namespace {

float random(Key key, Key i) { return uniform_float(hash_keys(key, i)); }
Vec3f random_point(Key key, Key i) {
  return Vec3f{random(key, 3 * i), random(key, 3 * i + 1), random(key, 3 * i + 2)} * 2.f - Vec3f(1);
}

void add_grid(Tessellation& t, int width, int height, const auto& position) {
  const auto first = std::uint32_t(t.positions.size());
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) t.positions.push_back(position(i, j));
  t.grids.push_back({first, std::uint16_t(width), std::uint16_t(height), 0, 0});
}

void add_triangle(Tessellation& t, Vec3f a, Vec3f b, Vec3f c) {
  const auto first = std::uint32_t(t.positions.size());
  t.positions.insert(t.positions.end(), {a, b, c});
  t.triangles.push_back({first, first + 1, first + 2});
  t.triangle_sources.push_back({std::uint32_t(t.triangles.size()), 0});
}

void leave_room(Tessellation& t) { t.positions.reserve(t.positions.size() + 1); }

// A heap of triangles and wavy grids of many sizes in a cube of side 2.
Tessellation heap(Key key, int triangles, int grids) {
  Tessellation t;
  for (int k = 0; k < grids; ++k) {
    const int sizes[] = {2, 3, 4, 5, 9, 17};
    const int width = sizes[hash_keys(key, Key(k), 1) % 6], height = sizes[hash_keys(key, Key(k), 2) % 6];
    const Vec3f at = random_point(key, Key(1000 + k)), along = random_point(key, Key(2000 + k)) * 0.4f,
                across = random_point(key, Key(3000 + k)) * 0.4f;
    add_grid(t, width, height, [&](int i, int j) {
      const float u = float(i) / float(width - 1), v = float(j) / float(height - 1);
      return at + along * u + across * v + random_point(hash_keys(key, Key(k)), Key(i * 100 + j)) * 0.02f;
    });
  }
  for (int k = 0; k < triangles; ++k) {
    const Vec3f at = random_point(key, Key(5000 + k));
    add_triangle(t, at, at + random_point(key, Key(100000 + k)) * 0.2f, at + random_point(key, Key(200000 + k)) * 0.2f);
  }
  leave_room(t);
  return t;
}

// All corners of all triangles, as for_each_triangle() has them.
std::vector<std::array<Vec3f, 3>> triangles_of(const Tessellation& t) {
  std::vector<std::array<Vec3f, 3>> all;
  for_each_triangle(t, [&](const std::array<std::uint32_t, 3>& c, std::uint32_t) {
    all.push_back({t.positions[c[0]], t.positions[c[1]], t.positions[c[2]]});
  });
  return all;
}

// Möller and Trumbore 1997, in double; infinity: missed. `margin` is how far from the nearest edge, as a weight.
double distance_to(const std::array<Vec3f, 3>& c, Vec3f origin, Vec3f direction, double& margin) {
  const Vec3d a(c[0]), e1 = Vec3d(c[1]) - a, e2 = Vec3d(c[2]) - a, d(direction), s = Vec3d(origin) - a;
  const Vec3d p = cross(d, e2), q = cross(s, e1);
  const double determinant = dot(e1, p);
  if (determinant == 0) return INFINITY;
  const double u = dot(s, p) / determinant, v = dot(d, q) / determinant, t = dot(e2, q) / determinant;
  margin = std::min({u, v, 1 - u - v});
  return margin >= 0 && t > 0 ? t : INFINITY;
}

struct Scene {
  explicit Scene(Tessellation tessellation) : t(std::move(tessellation)), tree((leave_room(t), t)) {}
  bool intersect(Vec3f origin, Vec3f direction, TreeHit& hit, float t_min = 0) const {
    return tree.intersect(t.positions.data(), TreeRay(origin, direction), t_min, hit);
  }
  bool occluded(Vec3f origin, Vec3f direction, float t_max, float t_min = 0) const {
    return tree.occluded(t.positions.data(), TreeRay(origin, direction), t_min, t_max);
  }
  Tessellation t;
  SurfaceTree tree;
};

// What flushes denormals for each test, as all threads that trace do.
class SurfaceTrees : public testing::Test {
 protected:
  void SetUp() override { flush_denormals(); }
};

}  // namespace

TEST_F(SurfaceTrees, FindsTheNearestTriangleOfAll) {
  for (const auto& [triangles, grids] : {std::pair{300, 40}, {0, 60}, {1, 0}, {7, 0}, {9, 0}, {0, 1}, {2000, 0}}) {
    const Scene scene(heap(Key(triangles + grids), triangles, grids));
    const auto all = triangles_of(scene.t);
    int met = 0;
    for (Key k = 0; k < 2000; ++k) {
      const Vec3f origin = random_point(7, k) * 1.5f, direction = (random_point(8, k) - origin) * (0.1f + random(9, k));
      double nearest = INFINITY, second = INFINITY, margin_of_nearest = 0;
      bool close_call = false;
      for (const auto& c : all) {
        double margin = -1;
        const double t = distance_to(c, origin, direction, margin);
        close_call |= std::abs(margin) < 1e-5;
        if (t < nearest)
          second = nearest, nearest = t, margin_of_nearest = margin;
        else
          second = std::min(second, t);
      }
      if (close_call || second < nearest * (1 + 1e-5) || nearest < 1e-5) continue;
      TreeHit hit{INFINITY};
      const bool found = scene.intersect(origin, direction, hit);
      ASSERT_EQ(found, nearest < INFINITY) << k;
      ASSERT_EQ(scene.occluded(origin, direction, INFINITY), found);
      if (!found) continue;
      ++met;
      ASSERT_NEAR(hit.t, nearest, 1e-4 * nearest);
      EXPECT_FALSE(scene.occluded(origin, direction, hit.t * 0.999f));
      EXPECT_TRUE(scene.occluded(origin, direction, hit.t));
      // The corners and weights say where that is.
      const SurfaceTree::Triangle c = scene.tree.triangle(hit.triangle);
      const Vec3f p = scene.t.positions[c.corners[0]] * (1 - hit.u - hit.v) + scene.t.positions[c.corners[1]] * hit.u +
                      scene.t.positions[c.corners[2]] * hit.v;
      ASSERT_LT(length(p - (origin + direction * hit.t)), 2e-5f);
      ASSERT_NEAR(std::min({hit.u, hit.v, 1 - hit.u - hit.v}), margin_of_nearest, 1e-3);
      // Beyond it is the next.
      TreeHit beyond{INFINITY};
      const bool more = scene.intersect(origin, direction, beyond, hit.t);
      EXPECT_EQ(more, second < INFINITY);
      EXPECT_GT(beyond.t, hit.t);
    }
    EXPECT_GT(met, triangles + grids > 30 ? 300 : -1);
  }
}

TEST_F(SurfaceTrees, BothKernelsGiveTheSameBits) {
  if (&best_tree_kernels() == &baseline_tree_kernels()) GTEST_SKIP() << "this processor has but one";
  Tessellation t = heap(5, 500, 50);
  BuiltTree tree;
  build_tree(t, false, tree);
  std::vector<std::array<std::uint32_t, 3>> sorted;
  for (std::uint32_t i : tree.triangles) sorted.push_back(t.triangles[i]);
  const TreeView view{tree.nodes.data(), sorted.data(), t.positions.data()};
  int met = 0;
  for (Key k = 0; k < 20000; ++k) {
    const Vec3f origin = random_point(1, k) * 1.5f;
    // Many towards vertices: every bit counts there.
    const Vec3f target = k % 2 ? t.positions[hash_keys(3, k) % t.positions.size()] : random_point(2, k);
    const TreeRay ray(origin, target - origin);
    TreeHit a{INFINITY}, b{INFINITY};
    ASSERT_EQ(avx2_tree_kernels().intersect(view, ray, 0, a), baseline_tree_kernels().intersect(view, ray, 0, b));
    ASSERT_EQ(std::tie(a.t, a.triangle, a.u, a.v), std::tie(b.t, b.triangle, b.u, b.v));
    ASSERT_EQ(avx2_tree_kernels().occluded(view, ray, 0, 0.9f), baseline_tree_kernels().occluded(view, ray, 0, 0.9f));
    met += a.triangle != TreeHit::none;
  }
  EXPECT_GT(met, 5000);
}

TEST_F(SurfaceTrees, PackedPositionsGiveTheSameBits) {
  Tessellation t = heap(6, 500, 50);
  for (Vec3f& p : t.positions) {
    const auto round = [](float x) { return std::round(x * 0x1p14f) * 0x1p-14f + 0.f; };
    p = {round(p.x), round(p.y), round(p.z)};
  }
  const SurfaceVertices packed(t.positions, {}, false);
  ASSERT_TRUE(packed.positions().is_packed());
  BuiltTree tree;
  build_tree(t, false, tree);
  std::vector<std::array<std::uint32_t, 3>> sorted;
  for (std::uint32_t i : tree.triangles) sorted.push_back(t.triangles[i]);
  const TreeView as_floats{tree.nodes.data(), sorted.data(), t.positions.data()},
      as_numbers{tree.nodes.data(), sorted.data(), packed.positions()};
  int met = 0;
  for (const TreeKernels* kernels : {&baseline_tree_kernels(), &best_tree_kernels()})
    for (Key k = 0; k < 10000; ++k) {
      const Vec3f origin = random_point(1, k) * 1.5f;
      const Vec3f target = k % 2 ? t.positions[hash_keys(3, k) % t.positions.size()] : random_point(2, k);
      const TreeRay ray(origin, target - origin);
      TreeHit a{INFINITY}, b{INFINITY};
      ASSERT_EQ(kernels->intersect(as_floats, ray, 0, a), kernels->intersect(as_numbers, ray, 0, b));
      ASSERT_EQ(std::tie(a.t, a.triangle, a.u, a.v), std::tie(b.t, b.triangle, b.u, b.v));
      ASSERT_EQ(kernels->occluded(as_floats, ray, 0, 0.9f), kernels->occluded(as_numbers, ray, 0, 0.9f));
      met += a.triangle != TreeHit::none;
      if (a.triangle != TreeHit::none) {
        const auto corners = SurfaceTree::triangle(as_floats.nodes, as_floats.triangles, a.triangle).corners;
        ASSERT_EQ(tie_key(as_floats.positions, corners), tie_key(as_numbers.positions, corners));
      }
    }
  EXPECT_GT(met, 5000);
}

// A rough ball of grids, as cells have them: every vertex of a border twice.
Tessellation rough_ball(int patches, int width) {
  Tessellation t;
  const auto point = [&](int i, int j) {
    const int around = patches * (width - 1), across = around / 2;
    const double theta = pi * double(j) / double(across), phi = 2 * pi * double(i % around) / double(around);
    const Vec3d d{std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
    const double r = j == 0 || j == across ? 1 : 1 + 0.1 * random(11, Key(i % around) * 10000 + Key(j));
    return Vec3f(d * r);
  };
  for (int a = 0; a < patches; ++a)
    for (int b = 0; b < patches / 2; ++b)
      add_grid(t, width, width, [&](int i, int j) { return point(a * (width - 1) + i, b * (width - 1) + j); });
  leave_room(t);
  return t;
}

TEST_F(SurfaceTrees, NoRayLeavesAClosedSurfaceBetweenTriangles) {
  const Scene scene(rough_ball(8, 9));
  const auto& p = scene.t.positions;
  int escaped = 0;
  for (Key k = 0; k < 300000; ++k) {
    const Vec3f origin = random_point(21, k) * 0.3f;
    // At a vertex, at a point of an edge or a diagonal, or anywhere.
    const Tessellation::Grid& grid = scene.t.grids[hash_keys(22, k) % scene.t.grids.size()];
    const std::uint32_t at = grid.first_vertex + std::uint32_t(hash_keys(23, k) % 8 + hash_keys(24, k) % 8 * 9);
    const std::uint32_t other = at + std::array<std::uint32_t, 3>{1, 9, 8}[hash_keys(25, k) % 3];
    const float w = k % 3 == 0 ? 0 : random(26, k);
    const Vec3f target = k % 3 == 2 ? random_point(27, k) : p[at] * (1 - w) + p[other] * w;
    TreeHit hit{INFINITY};
    if (target == origin) continue;
    escaped += !scene.intersect(origin, target - origin, hit);
    escaped += !scene.occluded(origin, target - origin, INFINITY);
  }
  EXPECT_EQ(escaped, 0);
}

// What lets a cell's hit have the bits of the whole model's.
TEST_F(SurfaceTrees, AHitDependsOnItsTriangleAlone) {
  const Tessellation whole = rough_ball(8, 9);
  const Scene scene{Tessellation(whole)};
  std::vector<std::unique_ptr<Scene>> parts;
  for (const Tessellation::Grid& grid : whole.grids) {
    Tessellation part;
    add_grid(part, 9, 9, [&](int i, int j) { return whole.positions[grid.first_vertex + std::uint32_t(j * 9 + i)]; });
    leave_room(part);
    parts.push_back(std::make_unique<Scene>(std::move(part)));
  }
  for (Key k = 0; k < 5000; ++k) {
    const Vec3f origin = random_point(31, k) * 3.f, direction = random_point(32, k) - origin;
    TreeHit of_whole{INFINITY}, of_parts{INFINITY};
    const bool met = scene.intersect(origin, direction, of_whole);
    bool met_a_part = false;
    for (const auto& part : parts) {
      TreeHit hit{of_parts.t};
      if (!part->intersect(origin, direction, hit)) continue;
      of_parts = hit;
      met_a_part = true;
    }
    ASSERT_EQ(met, met_a_part);
    ASSERT_EQ(of_whole.t, of_parts.t);
  }
}

TEST_F(SurfaceTrees, RaysAlongAxesMeetFlatSurfaces) {
  Tessellation t;  // a floor without any height, and a wall
  add_grid(t, 9, 9, [](int i, int j) { return Vec3f{float(i), 0, float(j)}; });
  add_grid(t, 9, 9, [](int i, int j) { return Vec3f{8, float(i), float(j)}; });
  leave_room(t);
  const Scene scene(std::move(t));
  for (int x = 0; x <= 8; ++x)
    for (int z = 0; z <= 8; ++z)
      for (float dx : {0.f, 0.5f}) {
        if (float(x) + dx > 8) continue;
        TreeHit hit{INFINITY};
        ASSERT_TRUE(scene.intersect({float(x) + dx, 3, float(z)}, {0, -2, 0}, hit));
        EXPECT_EQ(hit.t, 1.5f);
        hit = {INFINITY};
        ASSERT_TRUE(scene.intersect({-4, float(x) + dx, float(z)}, {1, 0, 0}, hit));
        EXPECT_EQ(hit.t, x == 0 && dx == 0 ? 12 : 12) << x;
        hit = {INFINITY};
        EXPECT_FALSE(scene.intersect({float(x) + dx, 3, float(z)}, {0, 1, 0}, hit));
        EXPECT_FALSE(scene.occluded({float(x) + dx, 3, float(z)}, {0, 1, -0.f}, INFINITY));
      }
}

TEST_F(SurfaceTrees, OfTrianglesAtOneDistanceItIsTheSameWhatevertheRaysEnd) {
  Tessellation t;
  for (int i = 0; i < 40; ++i) add_triangle(t, {0, 0, 1}, {1, 0, 1}, {0, 1, 1});
  leave_room(t);
  const Scene scene(std::move(t));
  TreeHit hit{INFINITY}, up_to_it{1};
  ASSERT_TRUE(scene.intersect({0.25f, 0.25f, 0}, {0, 0, 1}, hit));
  ASSERT_TRUE(scene.intersect({0.25f, 0.25f, 0}, {0, 0, 1}, up_to_it));
  EXPECT_EQ(hit.triangle, up_to_it.triangle);
  EXPECT_EQ(hit.triangle, 0u);
}

TEST_F(SurfaceTrees, WhatIsNotFiniteOrHasNoAreaIsNotMet) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  for (float bad : {nan, INFINITY, -INFINITY}) {
    Tessellation t;
    add_grid(t, 9, 9, [&](int i, int j) { return Vec3f{float(i), i == 4 && j == 4 ? bad : 0, float(j)}; });
    add_triangle(t, {0, bad, 0}, {8, 1, 0}, {0, 1, 8});
    add_triangle(t, {1, 2, 1}, {1, 2, 1}, {2, 2, 2});  // a segment
    add_triangle(t, {1, 2, 1}, {1, 2, 1}, {1, 2, 1});
    leave_room(t);
    const Scene scene(std::move(t));
    int met = 0;
    for (int x = 0; x < 8; ++x)
      for (int z = 0; z < 8; ++z) {
        TreeHit hit{INFINITY};
        if (!scene.intersect({float(x) + 0.3f, 4, float(z) + 0.3f}, {0, -1, 0}, hit)) continue;
        EXPECT_EQ(hit.t, 4);
        ++met;
      }
    EXPECT_EQ(met, 64 - 16);  // blocks of two by two quads
  }
  const Scene nothing{Tessellation{}};
  TreeHit hit{INFINITY};
  EXPECT_FALSE(nothing.intersect({}, {0, 0, 1}, hit));
  EXPECT_FALSE(nothing.occluded({}, {0, 0, 1}, INFINITY));
  EXPECT_LE(nothing.tree.bytes(), 0u);
}

TEST_F(SurfaceTrees, TrianglesKeepTheirSources) {
  const Tessellation before = heap(3, 100, 5);
  const Scene scene{Tessellation(before)};
  ASSERT_EQ(scene.t.triangles.size(), before.triangles.size());
  for (std::size_t i = 0; i < scene.t.triangles.size(); ++i) {
    const std::uint32_t was = scene.t.triangle_sources[i].origin - 1;
    EXPECT_EQ(scene.t.triangles[i], before.triangles[was]);
  }
}

TEST_F(SurfaceTrees, LargeTreesAreBuiltByManyThreadsAsByOne) {
  const Tessellation t = heap(13, 60000, 50);
  BuiltTree by_many, by_one;
  build_tree(t, true, by_many);
  build_tree(t, false, by_one);
  EXPECT_EQ(by_many.triangles, by_one.triangles);
  ASSERT_EQ(by_many.nodes.size(), by_one.nodes.size());
  EXPECT_EQ(std::memcmp(by_many.nodes.data(), by_one.nodes.data(), by_one.nodes.size() * sizeof(SurfaceTree::Node)), 0);
}

// 2.3 bytes a triangle: a node of 128 bytes has 8 blocks of 8, and there are nodes above.
TEST_F(SurfaceTrees, TakesLittleMemory) {
  const Scene scene(rough_ball(16, 17));
  const double triangles = 2.0 * 16 * 16 * double(scene.t.grids.size());
  EXPECT_LT(double(scene.tree.bytes()) / triangles, 3);
}
