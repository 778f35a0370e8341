#include "geometry/cells/uv_packing.h"

#include "geometry/base/key.h"

#include <gtest/gtest.h>

#include <cmath>

namespace meristem {
namespace {

TEST(UvLattice, StepsAreAShareOfTheWidestFaceAndNeverCoarse) {
  struct {
    float width, step;
  } const cases[] = {{0x1p-10f, 0x1p-19f}, {0x1.8p-10f, 0x1p-19f}, {0.01f, 0x1p-16f}, {0.5f, 0x1p-15f},
                     {1, 0x1p-15f},        {40, 0x1p-10f},         {0, 0x1p-15f}};
  for (const auto& c : cases)
    for (const float x : {0.0f, 0.123456789f, 0.9999f, -3.14159f}) {
      const Vec2f rounded = on_uv_lattice({x, 0.25f}, {c.width, 1});
      const double steps = double(rounded.x) / double(c.step);
      EXPECT_EQ(steps, std::round(steps)) << c.width;
      EXPECT_LE(std::abs(rounded.x - x), c.step / 2) << c.width;
      EXPECT_EQ(rounded.y, 0.25f);
    }
}

// Grids of every four of the first half of the vertices, triangles of every three of the others that follow each other.
Tessellation tessellation(const std::vector<Vec2f>& uv, std::vector<UvRange>& of_grids) {
  Tessellation t;
  t.positions.resize(uv.size());
  t.attributes.resize(uv.size());
  t.leaves = {{{}, 3}, {{}, 5}};
  const auto half = std::uint32_t(uv.size() / 2);
  for (std::uint32_t v = 0; v + 4 <= half; v += 4) {
    t.grids.push_back({v, 2, 2, 0, v / 4 % 2});
    of_grids.emplace_back();
    for (std::uint32_t i = 0; i < 4; ++i) of_grids.back().add(uv[v + i]);
  }
  for (std::uint32_t v = half; v + 3 <= uv.size(); ++v) {
    t.triangles.push_back({v, v + 1, v + 2});
    t.triangle_sources.push_back({0, 1});
  }
  return t;
}

TEST(UvPacking, LosesNothingInAsManyFramesAsItTakes) {
  for (const float spread : {0.0001f, 0.01f, 1.0f, 100.0f}) {
    std::vector<Vec2f> uv;
    for (std::size_t i = 0; i < 400; ++i) {
      const float along = spread * float(i / 4), height = i < 200 && i % 8 < 4 ? 0.00001f : 0.01f;
      const auto random = [&](Key k) { return uniform_float(hash_keys(Key(i), k)); };
      uv.push_back(on_uv_lattice({along + 0.01f * random(1), height * random(2)}, {0.01f + spread, height}));
    }
    std::vector<UvRange> of_grids;
    Tessellation t = tessellation(uv, of_grids);
    const auto before = t.triangles;
    std::vector<Vec2f> values = uv;
    pack_uv(values, of_grids, t);
    const std::vector<Vec2f> unpacked = vertex_uv(t);
    ASSERT_EQ(unpacked.size(), t.positions.size());
    for (std::size_t v = 0; v < 200; ++v) EXPECT_EQ(unpacked[v], uv[v]) << spread;
    for (std::size_t i = 0; i < before.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(unpacked[t.triangles[i][k]], uv[before[i][k]]) << spread;
    for (std::size_t g = 0; g < t.grids.size(); ++g) EXPECT_EQ(t.leaves[t.grids[g].leaf].level, g % 2 ? 5 : 3);
    EXPECT_LE(t.leaves.size(), spread < 1 ? 4u : 400u);
  }
}

// Within a step of its range over the triangle.
TEST(UvPacking, WhatFitsIntoNoFrameIsRounded) {
  std::vector<Vec2f> uv{{0, 0}, {1e6f, 0.1f}, {0.3f, 1e-6f}};
  Tessellation t;
  t.positions.resize(3);
  t.attributes.resize(3);
  t.leaves = {{}};
  t.triangles = {{0, 1, 2}};
  t.triangle_sources = {{0, 0}};
  std::vector<Vec2f> values = uv;
  pack_uv(values, {}, t);
  const std::vector<Vec2f> unpacked = vertex_uv(t);
  for (std::size_t v = 0; v < 3; ++v) {
    EXPECT_NEAR(unpacked[v].x, uv[v].x, 8);
    EXPECT_NEAR(unpacked[v].y, uv[v].y, 1e-6);
  }
}

}  // namespace
}  // namespace meristem
