// SurfacePatch: a surface that rays can meet, and what a hit on it means. Immutable; any thread may trace it.
#pragma once

#include "geometry/accel/surface.h"
#include "geometry/cells/surface_vertices.h"
#include "geometry/tree/surface_tree.h"

namespace meristem {

// Where on a surface a triangle stands, beside its corners.
struct TriangleSource {
  std::uint32_t origin, leaf;
  int coarser;  // by so many refinements than the leaf's other faces may be
};

// Everything about what was met but t and the object, in the frame of the surface; u and v are the weights of the
// second and third corner. The position comes from the vertices; its error bound covers the rounding of the
// interpolation.
void surface_at(const SurfaceFaces& faces, const SurfaceVertices& vertices, const std::array<std::uint32_t, 3>& corners,
                float u, float v, const TriangleSource& source, SurfaceHit& hit);

class SurfacePatch {
 public:
  explicit SurfacePatch(Tessellation tessellation, bool parallel = false);
  // The same from what another is made of.
  SurfacePatch(SurfaceFaces faces, SurfaceVertices vertices, std::vector<SurfaceTree::Node> nodes);
  SurfacePatch(const SurfacePatch&) = delete;  // the tree holds on to the triangles
  SurfacePatch& operator=(const SurfacePatch&) = delete;

  // As those of SurfaceTree.
  bool intersect(const TreeRay& ray, float t_min, TreeHit& hit) const {
    return tree_.intersect(positions(), ray, t_min, hit);
  }
  bool occluded(const TreeRay& ray, float t_min, float t_max) const {
    return tree_.occluded(positions(), ray, t_min, t_max);
  }

  const SurfaceFaces& faces() const { return faces_; }
  const SurfaceVertices& vertices() const { return vertices_; }
  PositionView positions() const { return vertices_.positions(); }
  const SurfaceTree& tree() const { return tree_; }
  std::size_t bytes() const { return sizeof(*this) + faces_.bytes() + vertices_.bytes() + tree_.bytes(); }

  // As the function above.
  void surface_at(const TreeHit& met, SurfaceHit& hit) const;
  // Asks for the memory that surface_at() will need.
  void prefetch(const TreeHit& hit) const;

 private:
  SurfaceTree tree_;  // first: it sorts the triangles of a tessellation
  SurfaceFaces faces_;
  SurfaceVertices vertices_;
};

}  // namespace meristem
