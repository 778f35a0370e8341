// Twigs for tests of braids and streams: surface trees whose boxes overlap.
#pragma once

#include "geometry/base/key.h"
#include "geometry/cells/surface_vertices.h"
#include "geometry/tree/braid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <compare>
#include <limits>
#include <vector>

namespace meristem {

inline float random(Key key, Key i) { return uniform_float(hash_keys(key, i)); }
inline Vec3f random_point(Key key, Key i) {
  return Vec3f{random(key, 3 * i), random(key, 3 * i + 1), random(key, 3 * i + 2)} * 2.f - Vec3f(1);
}

// Of positions that can be packed.
inline Vec3f on_lattice(Vec3f p) {
  const auto round = [](float x) { return std::round(x * 0x1p14f) * 0x1p-14f + 0.f; };
  return {round(p.x), round(p.y), round(p.z)};
}

// Leaves and a wavy grid along a twig that goes anywhere through the cube of side 2: boxes of twigs overlap.
inline Tessellation twig(Key key, int leaves) {
  Tessellation t;
  const Vec3f from = random_point(key, 1), along = random_point(key, 2) * 0.7f;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 17; ++i)
      t.positions.push_back(
          on_lattice(from + along * (float(i) / 16) + random_point(key, Key(10 + j * 17 + i)) * 0.02f));
  t.grids.push_back({0, 17, 3, 0, 0});
  for (int k = 0; k < leaves; ++k) {
    const auto first = std::uint32_t(t.positions.size());
    const Vec3f at = from + along * random(key, Key(100 + k));
    for (Key c = 0; c < 3; ++c) t.positions.push_back(on_lattice(at + random_point(hash_keys(key, Key(k)), c) * 0.05f));
    t.triangles.push_back({first, first + 1, first + 2});
    t.triangle_sources.push_back({0, 0});
  }
  t.positions.reserve(t.positions.size() + 1);
  return t;
}

struct Met {
  float t = std::numeric_limits<float>::infinity();
  std::uint32_t tree = ~0u, triangle = ~0u;
  auto operator<=>(const Met&) const = default;
};

inline TreeRay random_ray(Key k) {
  const Vec3f origin = random_point(7, k) * 1.5f;
  return {origin, (random_point(8, k) - origin) * (0.1f + random(9, k))};
}

// Keeps the nearest hit, of several the first, and notes the boxes that are entered.
struct Nearest final : BraidVisitor {
  using BraidVisitor::BraidVisitor;
  void met(std::uint32_t tree, const TreeHit& hit) override {
    ASSERT_LE(hit.t, t_max);
    nearest = std::min(nearest, {hit.t, tree, hit.triangle});
    t_max = nearest.t;
  }
  void enter(std::uint32_t other) override { entered.push_back(other); }
  Met nearest;
  std::vector<std::uint32_t> entered;
};

// Sixty of them, some without leaves, and one with nothing in it; the positions of every other one are packed.
class Twigs {
 public:
  Twigs() {
    for (Key key = 0; key < 60; ++key) twigs_.push_back(twig(key, key % 7 == 0 ? 0 : int(key) * 3));
    twigs_.push_back({});
    for (Tessellation& t : twigs_) {
      trees_.emplace_back(t);
      packed_.emplace_back(t.positions, std::span<const PackedAttributes>(), false);
      EXPECT_EQ(packed_.back().positions().is_packed(), !t.positions.empty());
    }
  }
  std::uint32_t size() const { return std::uint32_t(trees_.size()); }
  const SurfaceTree& tree(std::uint32_t i) const { return trees_[i]; }
  PositionView positions(std::uint32_t i) const {
    return i % 2 ? packed_[i].positions() : PositionView(twigs_[i].positions.data());
  }
  std::vector<Braid::Tree> list() const {
    std::vector<Braid::Tree> all;
    for (std::uint32_t i = 0; i < size(); ++i) all.push_back({&trees_[i], positions(i)});
    return all;
  }

 private:
  std::vector<Tessellation> twigs_;
  std::vector<SurfaceTree> trees_;
  std::vector<SurfaceVertices> packed_;
};

}  // namespace meristem
