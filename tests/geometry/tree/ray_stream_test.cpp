#include "geometry/tree/ray_stream.h"

#include "geometry/base/key.h"
#include "geometry/base/parallel.h"
#include "geometry/tree/tree_kernels.h"
#include "tests/geometry/tree/twigs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

using namespace meristem;

namespace {

// A ray through some legs, that keeps the nearest hit and notes the boxes that it enters.
class Traveller final : public StreamRay {
 public:
  Traveller(Key k, std::vector<Leg> legs) : legs_(std::move(legs)), ray_(random_ray(k)) {
    t_max = k % 3 == 0 ? INFINITY : random(11, k) * 4;
    any = k % 4 == 1;
    t_min_ = random(10, k) * 0.2f;
  }
  bool next(Leg& leg) override {
    if (at_ == legs_.size()) return false;
    leg = legs_[at_++];
    leg.ray = &ray_;
    leg.t_min = t_min_;
    return true;
  }
  void met(std::uint32_t tree, const TreeHit& hit) override {
    ASSERT_LE(hit.t, t_max);
    nearest = std::min(nearest, Met{hit.t, tree, hit.triangle});
    t_max = any ? -INFINITY : nearest.t;
    if (any) at_ = legs_.size();
  }
  void enter(std::uint32_t other) override { entered.push_back(other); }

  const TreeRay& ray() const { return ray_; }
  float t_min() const { return t_min_; }
  Met nearest;
  std::vector<std::uint32_t> entered;

 private:
  std::vector<Leg> legs_;
  std::size_t at_ = 0;
  TreeRay ray_;
  float t_min_;
};

class Stream final : public RayStream {
 public:
  explicit Stream(std::vector<Traveller>& rays) : rays_(rays) {}
  StreamRay* next(int lane) override {
    EXPECT_TRUE(lane >= 0 && lane < most_lanes);
    return next_ < rays_.size() ? &rays_[next_++] : nullptr;
  }

 private:
  std::vector<Traveller>& rays_;
  std::size_t next_ = 0;
};

std::vector<Traveller> travellers(std::size_t count, const std::vector<StreamRay::Leg>& legs) {
  std::vector<Traveller> rays;
  for (Key k = 0; k < count; ++k) rays.emplace_back(k, legs);
  return rays;
}

StreamRay::Leg through(const Braid& braid) { return {nullptr, 0, braid.view(), {}}; }
StreamRay::Leg through(const Twigs& twigs, std::uint32_t i) {
  const SurfaceTree& tree = twigs.tree(i);
  return {nullptr, 0, {nullptr, nullptr}, {tree.nodes().data(), tree.triangles(), twigs.positions(i), 0, i}};
}

// As rays meet a braid that go alone.
void expect_as_alone(const Braid& braid, const Traveller& ray, Key k) {
  const Traveller fresh(k, {});
  Nearest alone(fresh.t_max);
  if (fresh.any) {
    ASSERT_EQ(ray.nearest.t < INFINITY, braid.occluded(fresh.ray(), fresh.t_min(), alone)) << k;
    return;
  }
  braid.intersect(fresh.ray(), fresh.t_min(), alone);
  ASSERT_EQ(ray.nearest, alone.nearest) << k;
  ASSERT_EQ(ray.entered, alone.entered) << k;
}

}  // namespace

TEST(RayStream, MeetsInBraidsWhatRaysAloneMeet) {
  flush_denormals();
  const Twigs twigs;
  std::vector<Bounds3f> boxes;
  for (Key i = 0; i < 40; ++i) boxes.push_back({random_point(21, i) - Vec3f(0.1f), random_point(21, i) + Vec3f(0.1f)});
  for (const Braid& braid : {Braid(twigs.list(), {}), Braid(twigs.list(), boxes), Braid({}, boxes)})
    for (const std::size_t count : {1, 5, 16, 17, 2000}) {
      std::vector<Traveller> rays = travellers(count, {through(braid)});
      Stream(rays).run();
      for (Key k = 0; k < count; ++k) expect_as_alone(braid, rays[k], k);
    }
}

TEST(RayStream, GoesThroughOneLegAfterTheOther) {
  flush_denormals();
  const Twigs twigs;
  std::vector<StreamRay::Leg> legs;
  for (std::uint32_t i = 0; i < twigs.size(); ++i)
    if (!twigs.tree(i).nodes().empty()) legs.push_back(through(twigs, i));
  std::vector<Traveller> rays = travellers(3000, legs);
  Stream(rays).run();
  const Braid braid(twigs.list(), {});
  int met = 0;
  for (Key k = 0; k < rays.size(); ++k) {
    expect_as_alone(braid, rays[k], k);
    met += rays[k].nearest.t < INFINITY;
  }
  EXPECT_GT(met, 500);
  EXPECT_LT(met, 2500);
}

TEST(RayStream, EndsWhereThereAreNoRaysOrNoWays) {
  std::vector<Traveller> none, idle = travellers(40, {});
  Stream(none).run();
  Stream(idle).run();
  for (const Traveller& ray : idle) EXPECT_EQ(ray.nearest, Met{});
}

TEST(RayStream, BothKernelsMeetTheSame) {
  if (&best_tree_kernels() == &baseline_tree_kernels()) GTEST_SKIP() << "this processor has no AVX2";
  flush_denormals();
  const Twigs twigs;
  const Braid braid(twigs.list(), {});
  std::vector<Traveller> best = travellers(3000, {through(braid)}), baseline = best;
  Stream of_best(best), of_baseline(baseline);
  best_tree_kernels().run_stream(of_best);
  baseline_tree_kernels().run_stream(of_baseline);
  for (Key k = 0; k < best.size(); ++k)
    ASSERT_TRUE(best[k].any ? (best[k].nearest.t < INFINITY) == (baseline[k].nearest.t < INFINITY)
                            : best[k].nearest == baseline[k].nearest);
}
