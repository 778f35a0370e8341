#include "geometry/accel/surface_patch.h"

#include <algorithm>

namespace meristem {

namespace {

// The gradient of P along u over the triangle (in the plane of the triangle): zero if u, v do not vary.
Vec3f tangent_along_u(Vec3f e1, Vec3f e2, Vec2f t1, Vec2f t2) {
  const float determinant = t1.x * t2.y - t1.y * t2.x;
  return determinant != 0 ? (e1 * t2.y - e2 * t1.y) / determinant : Vec3f{};
}

// A shading normal is kept at least this far (as a cosine) on the side of the geometric one.
constexpr float least_normal_cosine = 0.01f;

Vec3f on_side_of(Vec3f shading, Vec3f geometric) {
  const float cosine = dot(shading, geometric);
  if (cosine >= least_normal_cosine) return normalize(shading);
  const Vec3f raised = normalize(shading + geometric * (least_normal_cosine - cosine));
  return raised == Vec3f{} ? geometric : raised;
}

}  // namespace

namespace {

// Kernels read 16 bytes of the last vertex: it needs room behind it (tessellate() has left it).
Tessellation with_room_behind(Tessellation t) {
  t.positions.reserve(t.positions.size() + 1);
  return t;
}

}  // namespace

SurfacePatch::SurfacePatch(Tessellation tessellation, bool parallel)
    : tessellation_(with_room_behind(std::move(tessellation))), tree_(tessellation_, parallel) {}

SurfacePatch::SurfacePatch(Tessellation tessellation, std::vector<SurfaceTree::Node> nodes)
    : tessellation_(with_room_behind(std::move(tessellation))), tree_(tessellation_, std::move(nodes)) {}

TriangleSource SurfacePatch::source_of(const SurfaceTree::Triangle& triangle) const {
  if (triangle.index != SurfaceTree::none) {
    const Tessellation::TriangleSource& source = tessellation_.triangle_sources[triangle.index];
    return {source.origin, source.leaf, 0};
  }
  const auto& grids = tessellation_.grids;  // by their vertices
  const Tessellation::Grid& grid =
      triangle.grid != SurfaceTree::none
          ? grids[triangle.grid]
          : *(std::ranges::upper_bound(grids, triangle.corners[0], {}, &Tessellation::Grid::first_vertex) - 1);
  return {grid.origin, grid.leaf, grid.coarser};
}

SurfaceHit surface_at(const Tessellation& t, const std::array<std::uint32_t, 3>& c, float u, float v,
                      const TriangleSource& source) {
  const float w = 1 - u - v;
  auto blend = [&](const auto& value) { return value(c[0]) * w + value(c[1]) * u + value(c[2]) * v; };
  const Tessellation::Leaf& leaf = t.leaves[source.leaf];
  auto uv_at = [&](std::uint32_t vertex) { return leaf.uv_frame.unpack(t.attributes[vertex].uv); };
  const Vec3f p0 = t.positions[c[0]], e1 = t.positions[c[1]] - p0, e2 = t.positions[c[2]] - p0;

  SurfaceHit hit;
  hit.position = blend([&](std::uint32_t vertex) { return t.positions[vertex]; });
  // Three products and two sums: gamma(5) of the sum of magnitudes (Pharr et al. 2023, sec. 6.8.4). The last term keeps
  // a floor under it where a coordinate is exactly zero.
  const Vec3f magnitude = abs(p0) + abs(e1) + abs(e2);
  hit.position_error = magnitude * (5 * 0x1p-24f) + Vec3f(max_component(magnitude) * 0x1p-24f);
  const Vec3f normal = cross(e1, e2);
  hit.shading_normal = blend([&](std::uint32_t vertex) { return t.attributes[vertex].normal.unpack(); });
  hit.geometric_normal = normalize(normal);
  if (hit.geometric_normal == Vec3f{}) hit.geometric_normal = normalize(hit.shading_normal);  // a degenerate triangle
  hit.shading_normal = on_side_of(hit.shading_normal, hit.geometric_normal);
  const Vec2f uv = blend(uv_at);
  hit.u = uv.x;
  hit.v = uv.y;
  const Vec2f t1 = uv_at(c[1]) - uv_at(c[0]), t2 = uv_at(c[2]) - uv_at(c[0]);
  hit.dpdu = tangent_along_u(e1, e2, t1, t2);
  hit.dpdv = tangent_along_u(e1, e2, {t1.y, t1.x}, {t2.y, t2.x});
  hit.level = leaf.level - source.coarser;
  hit.origin = t.origins[source.origin];
  return hit;
}

void SurfacePatch::prefetch(const TreeHit& hit) const {
  const SurfaceTree::Triangle triangle = tree_.triangle(hit.triangle);
  for (const std::uint32_t corner : triangle.corners) __builtin_prefetch(&tessellation_.attributes[corner]);
  if (triangle.index != SurfaceTree::none)
    __builtin_prefetch(&tessellation_.triangle_sources[triangle.index]);
  else if (triangle.grid != SurfaceTree::none)
    __builtin_prefetch(&tessellation_.grids[triangle.grid]);
}

SurfaceHit SurfacePatch::surface_at(const TreeHit& hit) const {
  const SurfaceTree::Triangle triangle = tree_.triangle(hit.triangle);
  for (std::uint32_t corner : triangle.corners) __builtin_prefetch(&tessellation_.attributes[corner]);
  return meristem::surface_at(tessellation_, triangle.corners, hit.u, hit.v, source_of(triangle));
}

}  // namespace meristem
