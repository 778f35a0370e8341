// SurfacePatch: a tessellation that rays can meet, and what a hit on it means. Immutable; any thread may trace it.
#pragma once

#include "geometry/accel/surface.h"
#include "geometry/tree/surface_tree.h"

namespace meristem {

// Where on a tessellation a triangle stands, beside its corners.
struct TriangleSource {
  std::uint32_t origin, leaf;
  int coarser;  // by so many refinements than the leaf's other faces may be
};

// Everything about what was met but t and the object, in the frame of the tessellation; u and v are the weights of the
// second and third corner. The position comes from the vertices; its error bound covers the rounding of the
// interpolation.
void surface_at(const Tessellation& tessellation, const std::array<std::uint32_t, 3>& corners, float u, float v,
                const TriangleSource& source, SurfaceHit& hit);

class SurfacePatch {
 public:
  explicit SurfacePatch(Tessellation tessellation, bool parallel = false);
  // The same from the tessellation and the nodes of the tree of another.
  SurfacePatch(Tessellation tessellation, std::vector<SurfaceTree::Node> nodes);
  SurfacePatch(const SurfacePatch&) = delete;  // the tree holds on to the triangles
  SurfacePatch& operator=(const SurfacePatch&) = delete;

  // As those of SurfaceTree.
  bool intersect(const TreeRay& ray, float t_min, TreeHit& hit) const {
    return tree_.intersect(tessellation_.positions.data(), ray, t_min, hit);
  }
  bool occluded(const TreeRay& ray, float t_min, float t_max) const {
    return tree_.occluded(tessellation_.positions.data(), ray, t_min, t_max);
  }

  const Tessellation& tessellation() const { return tessellation_; }
  const SurfaceTree& tree() const { return tree_; }
  std::size_t bytes() const { return sizeof(*this) + tessellation_.bytes() + tree_.bytes(); }

  // As the function above.
  void surface_at(const TreeHit& met, SurfaceHit& hit) const;
  // Asks for the memory that surface_at() will need.
  void prefetch(const TreeHit& hit) const;

 private:
  Tessellation tessellation_;
  SurfaceTree tree_;
};

}  // namespace meristem
