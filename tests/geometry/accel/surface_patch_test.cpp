// What a hit on a surface means: the bits of the formulas of vec.h and packing.h, however they are computed.
#include "geometry/accel/surface_patch.h"

#include "geometry/base/key.h"

#include <gtest/gtest.h>

#include <cmath>

namespace meristem {
namespace {

float number(Key a, Key b) { return 2 * uniform_float(hash_keys(a, b)) - 1; }
Vec3f vector(Key a, Key b) { return {number(a, 3 * b), number(a, 3 * b + 1), number(a, 3 * b + 2)}; }

// Triangles far apart in z, each with any normals and texture coordinates; some of one u and v. With a lattice of 2^-10
// up to 15 of them are packed.
Tessellation heap(int count, bool on_lattice = false) {
  Tessellation t;
  t.leaves = {{UvFrame::over({-1, 2}, {3, 2.5f}), 7}};
  for (std::uint32_t i = 0; i < std::uint32_t(count); ++i) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Vec3f p = vector(i, k);
      const Vec3f at{p.x, p.y, 0.5f * p.z + 4 * float(i)};
      const auto rounded = [](float x) { return std::round(x * 0x1p10f) * 0x1p-10f + 0.f; };
      t.positions.push_back(on_lattice ? Vec3f{rounded(at.x), rounded(at.y), rounded(at.z)} : at);
      const auto uv = [&](Key what) { return std::uint16_t(hash_keys(i, i % 5 == 0 ? 0 : k, what)); };
      t.attributes.push_back({PackedNormal::pack(normalize(vector(i, k + 3))), {uv(1), uv(2)}});
    }
    t.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    t.triangle_sources.push_back({0, 0});
  }
  FaceOrigin origin;
  origin.key = 5;
  t.origins.add(origin);
  return t;
}

Vec3f gradient(Vec3f e1, Vec3f e2, Vec2f t1, Vec2f t2) {
  const float determinant = t1.x * t2.y - t1.y * t2.x;
  return determinant != 0 ? (e1 * t2.y - e2 * t1.y) / determinant : Vec3f{};
}

Vec3f on_side_of(Vec3f shading, Vec3f geometric) {
  const float cosine = dot(shading, geometric);
  return normalize(cosine >= 0.01f ? shading : shading + geometric * (0.01f - cosine));
}

// What a patch of that surface says of rays at its triangles, of which there must be so many.
void expect_formulas(const Tessellation& surface, int least_hits) {
  const SurfacePatch patch(surface);
  const struct {  // sorted as those of the patch
    const std::vector<Vec3f>& positions;
    const std::vector<PackedAttributes>& attributes;
    const std::vector<SurfaceFaces::Leaf>& leaves;
    const std::vector<std::array<std::uint32_t, 3>>& triangles;
  } t{surface.positions, surface.attributes, surface.leaves, patch.faces().triangles};
  int hits = 0;
  for (std::uint32_t i = 0; i < t.triangles.size(); ++i) {
    const auto corner = [&](std::size_t k) { return t.positions[t.triangles[i][k]]; };
    const Vec3f inside = corner(0) * 0.5f + corner(1) * 0.2f + corner(2) * 0.3f, from = inside + vector(i, 9);
    TreeHit met{2};
    if (!patch.intersect(TreeRay(from, inside - from), 0, met)) continue;
    ++hits;
    SurfaceHit hit;
    patch.surface_at(met, hit);
    const auto c = patch.tree().triangle(met.triangle).corners;
    const auto blend = [&](const auto& at) {
      return at(c[0]) * (1 - met.u - met.v) + at(c[1]) * met.u + at(c[2]) * met.v;
    };
    const auto uv_at = [&](std::uint32_t v) { return t.leaves[0].uv_frame.unpack(t.attributes[v].uv); };
    const Vec3f p0 = t.positions[c[0]], e1 = t.positions[c[1]] - p0, e2 = t.positions[c[2]] - p0;
    EXPECT_EQ(hit.position, blend([&](std::uint32_t v) { return t.positions[v]; }));
    const Vec3f magnitude = abs(p0) + abs(e1) + abs(e2);
    EXPECT_EQ(hit.position_error, magnitude * (5 * 0x1p-24f) + Vec3f(max_component(magnitude) * 0x1p-24f));
    EXPECT_EQ(hit.geometric_normal, normalize(cross(e1, e2)));
    EXPECT_EQ(hit.shading_normal, on_side_of(blend([&](std::uint32_t v) { return t.attributes[v].normal.unpack(); }),
                                             hit.geometric_normal));
    const Vec2f uv = blend(uv_at), t1 = uv_at(c[1]) - uv_at(c[0]), t2 = uv_at(c[2]) - uv_at(c[0]);
    const bool has_uv = surface.has_uv;
    EXPECT_EQ((Vec2f{hit.u, hit.v}), has_uv ? uv : Vec2f{});
    EXPECT_EQ(hit.dpdu, has_uv ? gradient(e1, e2, t1, t2) : Vec3f{});
    EXPECT_EQ(hit.dpdv, has_uv ? gradient(e1, e2, {t1.y, t1.x}, {t2.y, t2.x}) : Vec3f{});
    EXPECT_EQ(hit.level, 7);
    EXPECT_EQ(hit.origin.key, 5u);
  }
  EXPECT_GE(hits, least_hits);
}

TEST(SurfacePatch, HitsHaveTheBitsOfTheirFormulas) { expect_formulas(heap(400), 390); }

TEST(SurfacePatch, AlsoWherePositionsArePacked) {
  const Tessellation surface = heap(15, true);
  EXPECT_TRUE(SurfacePatch(surface).positions().is_packed());
  expect_formulas(surface, 14);
}

TEST(SurfacePatch, WithoutUvHitsHaveNoneNorTangents) {
  Tessellation surface = heap(400);
  surface.has_uv = false;
  EXPECT_LT(SurfacePatch(surface).bytes(), SurfacePatch(heap(400)).bytes());
  expect_formulas(surface, 390);
}

}  // namespace
}  // namespace meristem
