#include "geometry/accel/surface_patch.h"

#include "geometry/base/parallel.h"

#include <algorithm>

namespace meristem {

namespace {

enum : unsigned { grids_id = 0, triangles_id = 1 };

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

struct SurfacePatch::Corners {
  std::uint32_t vertices[3];  // counter-clockwise seen from outside
  float weights[3];
  float extent_error;  // of the weights, for grids: Embree stores u, v over the whole grid
  std::uint32_t origin, leaf;
  int coarser;
};

SurfacePatch::SurfacePatch(Tessellation tessellation) : tessellation_(std::move(tessellation)) {
  scene_.reset(rtcNewScene(embree_device()));
  // Compact: Embree then takes its tree of four children a node for grids, not that of eight: 20 bytes a triangle all
  // told instead of 26, and rays are no slower (tests/bench/rays_bench.cpp).
  rtcSetSceneFlags(scene_.get(), RTCSceneFlags(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT));
  // Embree reads vertices 16 bytes at a time: the last one needs room behind it (tessellate() has left it).
  tessellation_.positions.reserve(tessellation_.positions.size() + 1);
  if (!tessellation_.grids.empty()) attach_grids();
  if (!tessellation_.triangles.empty()) attach_triangles();
  bytes_ = commit_scene(scene_.get()) + tessellation_.bytes() + sizeof(*this);
}

std::unique_ptr<SurfacePatch> SurfacePatch::make_isolated(Tessellation tessellation) {
  std::unique_ptr<SurfacePatch> patch;
  run_isolated([&] { patch = std::make_unique<SurfacePatch>(std::move(tessellation)); });
  return patch;
}

void SurfacePatch::share_vertices(RTCGeometry geometry) {
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, tessellation_.positions.data(), 0,
                             sizeof(Vec3f), tessellation_.positions.size());
}

void SurfacePatch::attach_grids() {
  RTCGeometry geometry = rtcNewGeometry(embree_device(), RTC_GEOMETRY_TYPE_GRID);
  share_vertices(geometry);
  auto* grids = static_cast<RTCGrid*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_GRID, 0, RTC_FORMAT_GRID,
                                                              sizeof(RTCGrid), tessellation_.grids.size()));
  for (const Tessellation::Grid& g : tessellation_.grids) *grids++ = {g.first_vertex, g.width, g.width, g.height};
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene_.get(), geometry, grids_id);
  rtcReleaseGeometry(geometry);
}

void SurfacePatch::attach_triangles() {
  RTCGeometry geometry = rtcNewGeometry(embree_device(), RTC_GEOMETRY_TYPE_TRIANGLE);
  share_vertices(geometry);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, tessellation_.triangles.data(), 0,
                             3 * sizeof(std::uint32_t), tessellation_.triangles.size());
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene_.get(), geometry, triangles_id);
  rtcReleaseGeometry(geometry);
}

SurfacePatch::Corners SurfacePatch::triangle_corners(const PatchHit& hit) const {
  const auto& t = tessellation_.triangles[hit.primitive];
  const Tessellation::TriangleSource& source = tessellation_.triangle_sources[hit.primitive];
  return {{t[0], t[1], t[2]}, {1 - hit.u - hit.v, hit.u, hit.v}, 0, source.origin, source.leaf, 0};
}

// Embree's u, v run over the whole grid; each quad is two triangles, (00, 10, 01) and (11, 01, 10).
SurfacePatch::Corners SurfacePatch::grid_corners(const PatchHit& hit) const {
  const Tessellation::Grid& grid = tessellation_.grids[hit.primitive];
  const float x = hit.u * float(grid.width - 1), y = hit.v * float(grid.height - 1);
  const std::uint32_t i = std::uint32_t(std::clamp(int(x), 0, grid.width - 2)),
                      j = std::uint32_t(std::clamp(int(y), 0, grid.height - 2));
  const float u = std::clamp(x - float(i), 0.0f, 1.0f), v = std::clamp(y - float(j), 0.0f, 1.0f);
  const std::uint32_t v00 = grid.first_vertex + j * grid.width + i, v10 = v00 + 1, v01 = v00 + grid.width,
                      v11 = v01 + 1;
  const float error = 4e-7f * float(std::max(grid.width, grid.height));
  if (u + v <= 1) return {{v00, v10, v01}, {1 - u - v, u, v}, error, grid.origin, grid.leaf, grid.coarser};
  return {{v11, v01, v10}, {u + v - 1, 1 - u, 1 - v}, error, grid.origin, grid.leaf, grid.coarser};
}

SurfaceHit SurfacePatch::surface_at(const PatchHit& patch_hit) const {
  const Corners c = patch_hit.geometry == grids_id ? grid_corners(patch_hit) : triangle_corners(patch_hit);
  const Tessellation& t = tessellation_;
  auto blend = [&](const auto& value) {
    return value(c.vertices[0]) * c.weights[0] + value(c.vertices[1]) * c.weights[1] +
           value(c.vertices[2]) * c.weights[2];
  };
  const Tessellation::Leaf& leaf = t.leaves[c.leaf];
  auto uv_at = [&](std::uint32_t v) { return leaf.uv_frame.unpack(t.uv[v]); };
  const Vec3f p0 = t.positions[c.vertices[0]], e1 = t.positions[c.vertices[1]] - p0,
              e2 = t.positions[c.vertices[2]] - p0;

  SurfaceHit hit;
  hit.position = blend([&](std::uint32_t v) { return t.positions[v]; });
  // Three products and two sums: gamma(5) of the sum of magnitudes (Pharr et al. 2023, sec. 6.8.4), and the error of
  // the weights.
  const Vec3f magnitude = abs(p0) + abs(e1) + abs(e2);
  // The last term keeps a floor under it where a coordinate is exactly zero: Embree counts a hit at t = 0.
  hit.position_error =
      magnitude * (5 * 0x1p-24f) + (abs(e1) + abs(e2)) * c.extent_error + Vec3f(max_component(magnitude) * 0x1p-24f);
  const Vec3f normal = cross(e1, e2);
  hit.shading_normal = blend([&](std::uint32_t v) { return t.normals[v].unpack(); });
  hit.geometric_normal = normalize(normal);
  if (hit.geometric_normal == Vec3f{}) hit.geometric_normal = normalize(hit.shading_normal);  // a degenerate triangle
  hit.shading_normal = on_side_of(hit.shading_normal, hit.geometric_normal);
  const Vec2f uv = blend(uv_at);
  hit.u = uv.x;
  hit.v = uv.y;
  const Vec2f t1 = uv_at(c.vertices[1]) - uv_at(c.vertices[0]), t2 = uv_at(c.vertices[2]) - uv_at(c.vertices[0]);
  hit.dpdu = tangent_along_u(e1, e2, t1, t2);
  hit.dpdv = tangent_along_u(e1, e2, {t1.y, t1.x}, {t2.y, t2.x});
  hit.level = leaf.level - c.coarser;
  hit.origin = t.origins[c.origin];
  return hit;
}

}  // namespace meristem
