#include "geometry/tree/braid.h"

#include "geometry/base/key.h"
#include "geometry/base/parallel.h"
#include "geometry/tree/tree_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace meristem;

namespace {

float random(Key key, Key i) { return uniform_float(hash_keys(key, i)); }
Vec3f random_point(Key key, Key i) {
  return Vec3f{random(key, 3 * i), random(key, 3 * i + 1), random(key, 3 * i + 2)} * 2.f - Vec3f(1);
}

// Leaves and a wavy grid along a twig that goes anywhere through the cube of side 2: boxes of twigs overlap.
Tessellation twig(Key key, int leaves) {
  Tessellation t;
  const Vec3f from = random_point(key, 1), along = random_point(key, 2) * 0.7f;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 17; ++i)
      t.positions.push_back(from + along * (float(i) / 16) + random_point(key, Key(10 + j * 17 + i)) * 0.02f);
  t.grids.push_back({0, 17, 3, 0, 0});
  for (int k = 0; k < leaves; ++k) {
    const auto first = std::uint32_t(t.positions.size());
    const Vec3f at = from + along * random(key, Key(100 + k));
    for (Key c = 0; c < 3; ++c) t.positions.push_back(at + random_point(hash_keys(key, Key(k)), c) * 0.05f);
    t.triangles.push_back({first, first + 1, first + 2});
    t.triangle_sources.push_back({0, 0});
  }
  t.positions.reserve(t.positions.size() + 1);
  return t;
}

struct Met {
  float t = std::numeric_limits<float>::infinity();
  std::uint32_t tree = ~0u, triangle = ~0u;
  bool operator==(const Met&) const = default;
  bool is_before(const Met& o) const { return std::tie(t, tree, triangle) < std::tie(o.t, o.tree, o.triangle); }
};

// Keeps the nearest hit, of several the first, and notes the boxes that are entered.
struct Nearest final : BraidVisitor {
  using BraidVisitor::BraidVisitor;
  void met(std::uint32_t tree, const TreeHit& hit) override {
    ASSERT_LE(hit.t, t_max);
    const Met next{hit.t, tree, hit.triangle};
    if (next.is_before(nearest)) nearest = next;
    t_max = nearest.t;
  }
  void enter(std::uint32_t other) override { entered.push_back(other); }
  Met nearest;
  std::vector<std::uint32_t> entered;
};

class Braids : public testing::Test {
 protected:
  void SetUp() override {
    flush_denormals();
    for (Key key = 0; key < 60; ++key) twigs_.push_back(twig(key, key % 7 == 0 ? 0 : int(key) * 3));
    twigs_.push_back({});  // nothing in it
    for (Tessellation& t : twigs_) trees_.emplace_back(t);
  }
  std::vector<Braid::Tree> list() const {
    std::vector<Braid::Tree> all;
    for (std::size_t i = 0; i < trees_.size(); ++i) all.push_back({&trees_[i], twigs_[i].positions.data()});
    return all;
  }
  Met one_by_one(const TreeRay& ray, float t_min, float t_max) const {
    Met nearest;
    for (std::uint32_t i = 0; i < trees_.size(); ++i) {
      TreeHit hit{t_max};
      if (!trees_[i].intersect(twigs_[i].positions.data(), ray, t_min, hit)) continue;
      if (const Met next{hit.t, i, hit.triangle}; next.is_before(nearest)) nearest = next;
    }
    return nearest;
  }

  std::vector<Tessellation> twigs_;
  std::vector<SurfaceTree> trees_;
};

}  // namespace

TEST_F(Braids, MeetWhatTheirTreesMeet) {
  const Braid braid(list(), {});
  int met = 0;
  for (Key k = 0; k < 20000; ++k) {
    const Vec3f origin = random_point(7, k) * 1.5f, direction = (random_point(8, k) - origin) * (0.1f + random(9, k));
    const TreeRay ray(origin, direction);
    const float t_min = random(10, k) * 0.2f, t_max = k % 3 == 0 ? INFINITY : random(11, k) * 4;
    const Met nearest = one_by_one(ray, t_min, t_max);
    Nearest visitor(t_max), any(t_max);
    braid.intersect(ray, t_min, visitor);
    ASSERT_EQ(visitor.nearest, nearest) << k;
    ASSERT_EQ(braid.occluded(ray, t_min, any), nearest.t < INFINITY) << k;
    met += nearest.t < INFINITY;
  }
  EXPECT_GT(met, 2000);
  EXPECT_LT(met, 18000);
}

// A triangle that is met twice at one distance, from parts of the tree that stand apart in the braid.
TEST_F(Braids, OfTrianglesAtOneDistanceTheFirstOfItsTreeIsMet) {
  Tessellation t;
  for (int i = 0; i < 300; ++i) {
    const auto first = std::uint32_t(t.positions.size());
    const float size = 1 + float(i % 10);
    t.positions.insert(t.positions.end(), {{0, 0, 1}, {size, 0, 1}, {0, size, 1}});
    t.triangles.push_back({first, first + 1, first + 2});
    t.triangle_sources.push_back({0, 0});
  }
  t.positions.reserve(t.positions.size() + 1);
  const SurfaceTree tree(t);
  const Braid braid(std::vector<Braid::Tree>{{&tree, t.positions.data()}}, {});
  const TreeRay ray({0.25f, 0.25f, 0}, {0, 0, 1});
  Nearest visitor(INFINITY);
  braid.intersect(ray, 0, visitor);
  TreeHit hit{INFINITY};
  ASSERT_TRUE(tree.intersect(t.positions.data(), ray, 0, hit));
  EXPECT_EQ(visitor.nearest, (Met{1, 0, hit.triangle}));
}

TEST_F(Braids, EnterOtherBoxesInTheOrderOfTheRayAndNoneBehindAHit) {
  Tessellation wall;
  wall.positions = {{5, -9, -9}, {5, 9, -9}, {5, 0, 9}};
  wall.triangles = {{0, 1, 2}};
  wall.triangle_sources = {{0, 0}};
  wall.positions.reserve(4);
  const SurfaceTree tree(wall);
  std::vector<Bounds3f> boxes;
  for (int i = 0; i < 40; ++i) {
    const float x = float((i * 7) % 40) / 4;
    boxes.push_back({{x, -1, -1}, {x + 0.1f, 1, 1}});
  }
  boxes.push_back({});                      // holds nothing
  boxes.push_back({{0, 2, 2}, {9, 3, 3}});  // beside the ray
  const Braid braid(std::vector<Braid::Tree>{{&tree, wall.positions.data()}}, boxes);
  const TreeRay ray({-1, 0, 0}, {1, 0, 0});
  Nearest visitor(INFINITY);
  braid.intersect(ray, 0, visitor);
  EXPECT_EQ(visitor.nearest, (Met{6, 0, 0}));
  std::vector<std::uint32_t> before;
  for (float x = 0; x < 5; x += 0.25f)
    for (std::uint32_t i = 0; i < 40; ++i)
      if (boxes[i].lower.x == x) before.push_back(i);
  visitor.entered.resize(std::min(visitor.entered.size(), before.size()));  // the one at the wall comes before or after
  EXPECT_EQ(visitor.entered, before);
}

TEST_F(Braids, EnterWhatHasNoEnd) {
  std::vector<Bounds3f> boxes(12, {{1, 1, 1}, {2, 2, 2}});
  boxes.push_back({{-INFINITY, -1, -1}, {INFINITY, 1, 1}});
  const Braid braid({}, boxes);
  Nearest visitor(INFINITY);
  braid.intersect(TreeRay({-3, 0, 0}, {1, 0, 0}), 0, visitor);
  EXPECT_TRUE(std::ranges::count(visitor.entered, 12u) == 1);
}

TEST_F(Braids, StopWhereAVisitIsEnough) {
  struct First final : BraidVisitor {
    First() : BraidVisitor(INFINITY) {}
    void met(std::uint32_t, const TreeHit&) override {}
    void enter(std::uint32_t) override {
      ++entered;
      t_max = -INFINITY;
    }
    int entered = 0;
  };
  const std::vector<Bounds3f> boxes(20, {{-1, -1, -1}, {1, 1, 1}});
  First visitor;
  EXPECT_TRUE(Braid({}, boxes).occluded(TreeRay({-3, 0, 0}, {1, 0, 0}), 0, visitor));
  EXPECT_EQ(visitor.entered, 1);
}

TEST_F(Braids, OfNothingMeetNothing) {
  const Braid braid({}, {});
  Nearest visitor(INFINITY);
  braid.intersect(TreeRay({}, {0, 0, 1}), 0, visitor);
  EXPECT_EQ(visitor.nearest, Met{});
  EXPECT_FALSE(braid.occluded(TreeRay({}, {0, 0, 1}), 0, visitor));
}

TEST_F(Braids, BothKernelsMeetTheSame) {
  if (&best_tree_kernels() == &baseline_tree_kernels()) GTEST_SKIP() << "this processor has no AVX2";
  std::vector<SurfaceTree::Node> nodes;
  const Braid braid(list(), {});
  for (Key k = 0; k < 5000; ++k) {
    const Vec3f origin = random_point(17, k) * 1.5f;
    const TreeRay ray(origin, random_point(18, k) - origin);
    Nearest best(INFINITY), baseline(INFINITY);
    best_tree_kernels().intersect_braid(braid.view(), ray, 0, best);
    baseline_tree_kernels().intersect_braid(braid.view(), ray, 0, baseline);
    ASSERT_EQ(best.nearest, baseline.nearest);
  }
}
