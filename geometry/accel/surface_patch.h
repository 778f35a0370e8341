// SurfacePatch: a tessellation in an Embree scene of its own, and what a hit on it means.
// Immutable; any thread may trace it.
#pragma once

#include "geometry/accel/embree_device.h"
#include "geometry/accel/surface.h"
#include "geometry/cells/tessellation.h"

namespace meristem {

// Where in a patch a ray met it, as Embree reports it.
struct PatchHit {
  unsigned geometry = RTC_INVALID_GEOMETRY_ID;  // grids or triangles
  unsigned primitive = 0;
  float u = 0, v = 0;
};

class SurfacePatch {
 public:
  // Builds on the calling thread; call inside run_isolated() (make_isolated() does).
  explicit SurfacePatch(Tessellation tessellation);
  static std::unique_ptr<SurfacePatch> make_isolated(Tessellation tessellation);

  RTCScene scene() const { return scene_.get(); }
  const Tessellation& tessellation() const { return tessellation_; }
  std::size_t bytes() const { return bytes_; }

  // Everything about a hit but t and the object, in the frame of the tessellation. The position comes from the
  // vertices; its error bound covers the rounding of the interpolation and of the stored u, v.
  SurfaceHit surface_at(const PatchHit& hit) const;

 private:
  struct Corners;  // a triangle of the patch and the hit's weights in it
  Corners triangle_corners(const PatchHit& hit) const;
  Corners grid_corners(const PatchHit& hit) const;
  void attach_grids();
  void attach_triangles();
  void share_vertices(RTCGeometry geometry);

  Tessellation tessellation_;
  ScenePtr scene_;
  std::size_t bytes_ = 0;
};

}  // namespace meristem
