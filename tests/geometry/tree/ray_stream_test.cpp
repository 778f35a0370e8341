#include "geometry/tree/ray_stream.h"

#include "geometry/base/key.h"
#include "geometry/base/parallel.h"
#include "geometry/tree/tree_kernels.h"
#include "tests/geometry/tree/travellers.h"

#include <gtest/gtest.h>

#include <array>

using namespace meristem;

namespace {

template <class Ray>
class Stream final : public RayStream {
 public:
  explicit Stream(std::vector<Ray>& rays) : rays_(rays) {}
  StreamRay* next(int lane) override {
    EXPECT_TRUE(lane >= 0 && lane < most_lanes);
    return next_ < rays_.size() ? &rays_[next_++] : nullptr;
  }

 private:
  std::vector<Ray>& rays_;
  std::size_t next_ = 0;
};

std::vector<Traveller> travellers(std::size_t count, const std::vector<StreamRay::Leg>& legs) {
  std::vector<Traveller> rays;
  for (Key k = 0; k < count; ++k) rays.emplace_back(k, legs);
  return rays;
}

void expect_as_alone(const Braid& braid, const Traveller& ray, Key k) {
  const Traveller fresh(k, {});
  Nearest alone(fresh.t_max);
  expect_met_as_alone(braid, ray, fresh, alone);
  if (!fresh.any) {
    ASSERT_EQ(ray.entered, alone.entered) << k;
  }
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

TEST(RayStream, LegsNest) {
  flush_denormals();
  const Twigs twigs;
  const Boughs boughs(twigs);
  const Braid all(twigs.list(), {});
  const std::vector<Traveller> fresh = travellers(3000, {});
  std::vector<Climber> rays = climbers(boughs, fresh);
  Stream(rays).run();
  Climbed climbed;
  climbed.expect_met_as_alone(all, rays, fresh);
  EXPECT_GT(climbed.nested, 3000);
  EXPECT_GT(climbed.alone, 1000);
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
