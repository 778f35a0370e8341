// What a user of Embree would do without cells: the grids of a model in one scene, all resident, and what a hit means.
#pragma once

#include "geometry/accel/embree_device.h"
#include "geometry/accel/surface_patch.h"
#include "geometry/cells/shown_surfaces.h"

#include <algorithm>
#include <vector>

namespace meristem {

class EmbreeGrids {
 public:
  // Of models that end in grids alone.
  explicit EmbreeGrids(std::shared_ptr<const Model> model) : scene_(rtcNewScene(embree_device())) {
    for_each_tessellation({std::move(model), nullptr, 0, {}}, [&](const Tessellation& cell, double) {
      cells_.push_back(cell);
      cells_.back().positions.reserve(cell.positions.size() + 1);  // Embree reads 16 bytes of the last
      vertices_.emplace_back(cell.positions, cell.attributes, cell.has_uv);
    });
    rtcSetSceneFlags(scene_.get(), RTCSceneFlags(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT));
    for (unsigned i = 0; i < cells_.size(); ++i) attach(cells_[i], i);
    commit_scene(scene_.get());
  }

  bool intersect(const Ray& ray, SurfaceHit& hit) const {
    RTCRayHit query = query_of(ray);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_.get(), &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    set_surface(cells_[query.hit.geomID], vertices_[query.hit.geomID], query.hit, hit);
    hit.t = query.ray.tfar;
    return true;
  }

 private:
  void attach(const Tessellation& cell, unsigned id) {
    RTCGeometry geometry = rtcNewGeometry(embree_device(), RTC_GEOMETRY_TYPE_GRID);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, cell.positions.data(), 0,
                               sizeof(Vec3f), cell.positions.size());
    auto* grids = static_cast<RTCGrid*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_GRID, 0, RTC_FORMAT_GRID,
                                                                sizeof(RTCGrid), cell.grids.size()));
    for (const Tessellation::Grid& g : cell.grids) *grids++ = {g.first_vertex, g.width, g.width, g.height};
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene_.get(), geometry, id);
    rtcReleaseGeometry(geometry);
  }

  // Embree's u, v run over the whole grid; each quad is two triangles, (00, 10, 01) and (11, 01, 10).
  static void set_surface(const SurfaceFaces& cell, const SurfaceVertices& vertices, const RTCHit& met,
                          SurfaceHit& hit) {
    const Tessellation::Grid& grid = cell.grids[met.primID];
    const float x = met.u * float(grid.width - 1), y = met.v * float(grid.height - 1);
    const auto i = std::uint32_t(std::clamp(int(x), 0, grid.width - 2)),
               j = std::uint32_t(std::clamp(int(y), 0, grid.height - 2));
    const float u = std::clamp(x - float(i), 0.0f, 1.0f), v = std::clamp(y - float(j), 0.0f, 1.0f);
    const std::uint32_t v00 = grid.first_vertex + j * grid.width + i, v10 = v00 + 1, v01 = v00 + grid.width;
    const TriangleSource source{grid.origin, grid.leaf, grid.coarser};
    if (u + v <= 1)
      surface_at(cell, vertices, {v00, v10, v01}, u, v, source, hit);
    else
      surface_at(cell, vertices, {v01 + 1, v01, v10}, 1 - u, 1 - v, source, hit);
  }

  std::vector<Tessellation> cells_;
  std::vector<SurfaceVertices> vertices_;
  ScenePtr scene_;
};

}  // namespace meristem
