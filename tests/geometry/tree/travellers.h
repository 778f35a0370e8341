// Travellers for tests of streams and packets: rays that keep the nearest hit and note the boxes that they enter.
#pragma once

#include "geometry/tree/ray_stream.h"
#include "tests/geometry/tree/twigs.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

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

// A braid that stands in a box of another: of twigs, or of boughs.
struct Bough {
  explicit Bough(std::span<const Braid::Tree> twigs, std::uint32_t first = 0) : braid(twigs, {}), first_twig(first) {}
  explicit Bough(std::vector<const Bough*> boughs) : inside(std::move(boughs)), braid({}, boxes(inside)) {}

  std::vector<const Bough*> inside;
  Braid braid;
  std::uint32_t first_twig = 0;

 private:
  static std::vector<Bounds3f> boxes(const std::vector<const Bough*>& boughs) {
    std::vector<Bounds3f> boxes;
    for (const Bough* b : boughs) boxes.push_back(b->braid.bounds());
    return boxes;
  }
};

// A ray that goes from bough to bough, as legs one in the other as long as it may.
class Climber final : public StreamRay {
 public:
  Climber(const Bough& root, const Traveller& like) : root_(&root), ray_(like.ray()), t_min_(like.t_min()) {
    t_max = like.t_max;
    any = like.any;
  }
  bool next(Leg& leg) override {
    if (!root_) return false;
    way_ = {root_};
    leg = into(*std::exchange(root_, nullptr));
    return true;
  }
  void met(std::uint32_t tree, const TreeHit& hit) override {
    ASSERT_LE(hit.t, t_max);
    nearest = std::min(nearest, Met{hit.t, way_.back()->first_twig + tree, hit.triangle});
    t_max = any ? -INFINITY : nearest.t;
  }
  void enter(std::uint32_t other) override {
    ++entered_alone;
    go_alone(*way_.back()->inside[other]);
  }
  bool enter(std::uint32_t other, Leg& inside) override {
    way_.push_back(way_.back()->inside[other]);
    EXPECT_LE(way_.size(), 1 + most_nested);
    inside = into(*way_.back());
    ++legs_inside;
    return true;
  }
  void leave() override { way_.pop_back(); }

  Met nearest;
  int entered_alone = 0, legs_inside = 0;

 private:
  struct Alone final : BraidVisitor {
    explicit Alone(Climber& c) : BraidVisitor(c.t_max), climber(c) {}
    void met(std::uint32_t tree, const TreeHit& hit) override {
      climber.met(tree, hit);
      t_max = climber.t_max;
    }
    void enter(std::uint32_t other) override {
      climber.go_alone(*climber.way_.back()->inside[other]);
      t_max = climber.t_max;
    }
    Climber& climber;
  };
  Leg into(const Bough& bough) const { return {&ray_, t_min_, bough.braid.view(), {}}; }
  void go_alone(const Bough& bough) {
    way_.push_back(&bough);
    Alone visitor(*this);
    if (!any)
      bough.braid.intersect(ray_, t_min_, visitor);
    else if (bough.braid.occluded(ray_, t_min_, visitor))
      nearest.t = 0, t_max = -INFINITY;
    way_.pop_back();
  }

  const Bough* root_;
  TreeRay ray_;
  float t_min_;
  std::vector<const Bough*> way_;
};

// Boughs of ten twigs in others of two, in one, in one more: deeper than legs may nest.
struct Boughs {
  explicit Boughs(const Twigs& twigs) {
    const std::vector<Braid::Tree> list = twigs.list();
    constexpr std::size_t each = 10;
    for (std::size_t first = 0; first < list.size(); first += each)
      all.emplace_back(std::span(list).subspan(first, std::min(each, list.size() - first)), std::uint32_t(first));
    std::vector<const Bough*> pairs;
    const std::size_t last = all.size() - 1;
    for (std::size_t i = 0; i < last; i += 2) {
      all.emplace_back(std::vector<const Bough*>{&all[i], &all[i + 1]});
      pairs.push_back(&all.back());
    }
    all.emplace_back(std::move(pairs));
    all.emplace_back(std::vector<const Bough*>{&all.back(), &all[last]});
  }
  const Bough& root() const { return all.back(); }

  std::deque<Bough> all;
};

inline StreamRay::Leg through(const Braid& braid) { return {nullptr, 0, braid.view(), {}}; }
inline StreamRay::Leg through(const Twigs& twigs, std::uint32_t i) {
  const SurfaceTree& tree = twigs.tree(i);
  return {nullptr, 0, {nullptr, nullptr}, {tree.nodes().data(), tree.triangles(), twigs.positions(i), 0, i}};
}

// That it has met in a braid what `fresh`, the same ray before it went, meets there alone.
template <class Ray>
void expect_met_as_alone(const Braid& braid, const Ray& ray, const Traveller& fresh, Nearest& alone) {
  if (fresh.any) {
    ASSERT_EQ(ray.nearest.t < INFINITY, braid.occluded(fresh.ray(), fresh.t_min(), alone));
    return;
  }
  braid.intersect(fresh.ray(), fresh.t_min(), alone);
  ASSERT_EQ(ray.nearest, alone.nearest);
}

// Climbers that have met what their rays, as `fresh` has them, meet in one braid of all twigs, and how they went.
struct Climbed {
  int nested = 0, alone = 0;

  void expect_met_as_alone(const Braid& all, const std::vector<Climber>& rays, const std::vector<Traveller>& fresh) {
    for (std::size_t k = 0; k < rays.size(); ++k) {
      Nearest expected(fresh[k].t_max);
      meristem::expect_met_as_alone(all, rays[k], fresh[k], expected);
      nested += rays[k].legs_inside;
      alone += rays[k].entered_alone;
    }
  }
};

inline std::vector<Climber> climbers(const Boughs& boughs, const std::vector<Traveller>& like) {
  std::vector<Climber> rays;
  for (const Traveller& ray : like) rays.emplace_back(boughs.root(), ray);
  return rays;
}

}  // namespace meristem
