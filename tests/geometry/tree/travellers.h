// Travellers for tests of streams and packets: rays that keep the nearest hit and note the boxes that they enter.
#pragma once

#include "geometry/tree/ray_stream.h"
#include "tests/geometry/tree/twigs.h"

#include <algorithm>
#include <cmath>

namespace meristem {

// A ray through some legs.
class Traveller final : public StreamRay {
 public:
  Traveller(Key k, std::vector<Leg> legs) : Traveller(k, std::move(legs), random_ray(k)) {}
  Traveller(Key k, std::vector<Leg> legs, const TreeRay& ray) : legs_(std::move(legs)), ray_(ray) {
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

inline StreamRay::Leg through(const Braid& braid) { return {nullptr, 0, braid.view(), {}}; }
inline StreamRay::Leg through(const Twigs& twigs, std::uint32_t i) {
  const SurfaceTree& tree = twigs.tree(i);
  return {nullptr, 0, {nullptr, nullptr}, {tree.nodes().data(), tree.triangles(), twigs.positions(i), 0, i}};
}

// That it has met in a braid what `fresh`, the same ray before it went, meets there alone.
inline void expect_met_as_alone(const Braid& braid, const Traveller& ray, const Traveller& fresh, Nearest& alone) {
  if (fresh.any) {
    ASSERT_EQ(ray.nearest.t < INFINITY, braid.occluded(fresh.ray(), fresh.t_min(), alone));
    return;
  }
  braid.intersect(fresh.ray(), fresh.t_min(), alone);
  ASSERT_EQ(ray.nearest, alone.nearest);
}

}  // namespace meristem
