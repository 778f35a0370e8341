#include "geometry/tree/braid.h"

#include "geometry/base/key.h"
#include "geometry/base/parallel.h"
#include "geometry/tree/tree_kernels.h"
#include "tests/geometry/tree/twigs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace meristem;

namespace {

class Braids : public testing::Test {
 protected:
  void SetUp() override { flush_denormals(); }
  std::vector<Braid::Tree> list() const { return twigs_.list(); }
  Met one_by_one(const TreeRay& ray, float t_min, float t_max) const {
    Met nearest;
    for (std::uint32_t i = 0; i < twigs_.size(); ++i) {
      TreeHit hit{t_max};
      if (!twigs_.tree(i).intersect(twigs_.positions(i), ray, t_min, hit)) continue;
      nearest = std::min(nearest, Met{hit.t, i, hit.triangle});
    }
    return nearest;
  }

 private:
  const Twigs twigs_;
};

}  // namespace

TEST_F(Braids, MeetWhatTheirTreesMeet) {
  const Braid braid(list(), {});
  int met = 0;
  for (Key k = 0; k < 20000; ++k) {
    const TreeRay ray = random_ray(k);
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

// Of what is met at one distance it keeps what a tree would.
class FirstOfTies final : public BraidVisitor {
 public:
  FirstOfTies(const SurfaceTree& tree, const Vec3f* positions)
      : BraidVisitor(INFINITY), tree_(tree), positions_(positions) {}
  void met(std::uint32_t, const TreeHit& hit) override {
    const std::pair rank(tie_key(positions_, tree_.triangle(hit.triangle).corners), hit.triangle);
    if (hit.t < t_max || rank < rank_) rank_ = rank;
    t_max = hit.t;
  }
  void enter(std::uint32_t) override {}
  std::uint32_t triangle() const { return rank_.second; }

 private:
  const SurfaceTree& tree_;
  const Vec3f* const positions_;
  std::pair<Key, std::uint32_t> rank_{0, TreeHit::none};
};

// Triangles that are met at one distance, in parts of the tree that stand apart in the braid.
TEST_F(Braids, OfTrianglesAtOneDistanceThatOfTheTreeIsMet) {
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
  FirstOfTies visitor(tree, t.positions.data());
  braid.intersect(ray, 0, visitor);
  TreeHit hit{INFINITY};
  ASSERT_TRUE(tree.intersect(t.positions.data(), ray, 0, hit));
  EXPECT_EQ(visitor.t_max, 1);
  EXPECT_EQ(visitor.triangle(), hit.triangle);
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
