#include "geometry/tree/ray_packet.h"

#include "geometry/base/parallel.h"
#include "geometry/tree/tree_kernels.h"
#include "tests/geometry/tree/travellers.h"

#include <gtest/gtest.h>

using namespace meristem;

namespace {

// From one place, as far apart as `spread`: a pixel, a picture or anywhere.
TreeRay ray_of(Key group, Key k, float spread) {
  const Vec3f origin = random_point(31, group) * 1.5f, to = random_point(32, group) * 0.6f;
  return {origin, to + random_point(33, k) * spread - origin};
}

std::vector<Traveller> travellers(std::size_t count, const std::vector<StreamRay::Leg>& legs, float spread) {
  std::vector<Traveller> rays;
  for (Key k = 0; k < count; ++k) rays.emplace_back(k, legs, ray_of(k / 64, k, spread));
  return rays;
}

template <class Ray>
void trace(std::vector<Ray>& rays, std::size_t together) {
  for (std::size_t i = 0; i < rays.size(); i += together) {
    RayPacket packet;
    for (std::size_t j = i; j < std::min(i + together, rays.size()); ++j) packet.add(rays[j]);
    packet.run();
  }
}

}  // namespace

TEST(RayPacket, MeetsWhatRaysAloneMeet) {
  flush_denormals();
  const Twigs twigs;
  const Braid braid(twigs.list(), {});
  std::vector<StreamRay::Leg> one_by_one;
  for (std::uint32_t i = 0; i < twigs.size(); ++i)
    if (!twigs.tree(i).nodes().empty()) one_by_one.push_back(through(twigs, i));
  int met = 0;
  for (const auto& legs : {std::vector{through(braid)}, one_by_one})
    for (const float spread : {0.002f, 0.2f, 3.f})
      for (const std::size_t together : {1, 5, 8}) {
        std::vector<Traveller> rays = travellers(1500, legs, spread), fresh = rays;
        trace(rays, together);
        for (std::size_t k = 0; k < rays.size(); ++k) {
          Nearest alone(fresh[k].t_max);
          expect_met_as_alone(braid, rays[k], fresh[k], alone);
          met += rays[k].nearest.t < INFINITY;
        }
      }
  EXPECT_GT(met, 3000);
  EXPECT_LT(met, 20000);
}

TEST(RayPacket, PacketsNest) {
  flush_denormals();
  const Twigs twigs;
  const Boughs boughs(twigs);
  const Braid all(twigs.list(), {});
  Climbed climbed;
  for (const float spread : {0.002f, 0.2f, 3.f})
    for (const std::size_t together : {1, 5, 8}) {
      const std::vector<Traveller> fresh = travellers(1500, {}, spread);
      std::vector<Climber> rays = climbers(boughs, fresh);
      trace(rays, together);
      climbed.expect_met_as_alone(all, rays, fresh);
    }
  EXPECT_GT(climbed.nested, 3000);
  EXPECT_GT(climbed.alone, 3000);
}

// What is in a box may have to be expanded: only for a ray that needs it.
TEST(RayPacket, EachRayEntersItsOwnBoxes) {
  flush_denormals();
  std::vector<Bounds3f> boxes;
  for (Key i = 0; i < 60; ++i) boxes.push_back({random_point(21, i) - Vec3f(0.1f), random_point(21, i) + Vec3f(0.1f)});
  const Braid braid({}, boxes);
  std::vector<Traveller> rays = travellers(1600, {through(braid)}, 0.2f), fresh = rays;
  trace(rays, RayPacket::most);
  std::size_t entered = 0;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    if (rays[k].any) continue;
    Nearest alone(fresh[k].t_max);
    braid.intersect(fresh[k].ray(), fresh[k].t_min(), alone);
    std::ranges::sort(rays[k].entered);
    std::ranges::sort(alone.entered);
    ASSERT_EQ(rays[k].entered, alone.entered);
    entered += alone.entered.size();
  }
  EXPECT_GT(entered, 1000u);
}

TEST(RayPacket, BothKernelsMeetTheSame) {
  if (&best_tree_kernels() == &baseline_tree_kernels()) GTEST_SKIP() << "this processor has no AVX2";
  flush_denormals();
  const Twigs twigs;
  const Braid braid(twigs.list(), {});
  for (Key group = 0; group < 300; ++group) {
    const auto met = [&](const TreeKernels& kernels) {
      std::vector<Traveller> rays;
      std::vector<StreamRay*> pointers;
      std::vector<StreamRay::Leg> legs(RayPacket::most);
      for (Key k = 0; k < RayPacket::most; ++k)
        rays.emplace_back(4 * k, std::vector{through(braid)}, ray_of(group, k, 0.001f));
      for (std::size_t k = 0; k < rays.size(); ++k) {
        pointers.push_back(&rays[k]);
        rays[k].next(legs[k]);
      }
      kernels.run_packet(pointers.data(), legs.data(), rays.size());
      std::vector<Met> result;
      for (const Traveller& ray : rays) result.push_back(ray.nearest);
      return result;
    };
    ASSERT_EQ(met(best_tree_kernels()), met(baseline_tree_kernels()));
  }
}
