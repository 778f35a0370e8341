// The loops of SurfaceTree and Braid for rays, once for each instruction set.
#pragma once

#include "geometry/tree/braid.h"
#include "geometry/tree/ray_stream.h"
#include "geometry/tree/surface_tree.h"

namespace meristem {

struct TreeView {
  const SurfaceTree::Node* nodes;
  const std::array<std::uint32_t, 3>* triangles;
  PositionView positions;
};

// Of two triangles of a tree, as TreeHit names them, that a ray meets at one distance: whether it is the first that it
// meets. Rare, hence dear.
[[gnu::cold]] bool wins_tie(const TreeView& tree, std::uint32_t a, std::uint32_t b);
// The same of the triangles in two lanes of a block. Where there are fewer than lanes, the last stands in all that are
// left.
[[gnu::cold]] bool wins_tie_in_block(const TreeView& tree, std::uint32_t block, int a, int b);

struct TreeKernels {
  bool (*intersect)(const TreeView& tree, const TreeRay& ray, float t_min, TreeHit& hit);
  bool (*occluded)(const TreeView& tree, const TreeRay& ray, float t_min, float t_max);
  void (*intersect_braid)(const Braid::View& braid, const TreeRay& ray, float t_min, BraidVisitor& visitor);
  bool (*occlude_braid)(const Braid::View& braid, const TreeRay& ray, float t_min, BraidVisitor& visitor);
  void (*run_stream)(RayStream& rays);
  // Of one leg each, along the same axis with the same signs.
  void (*run_packet)(StreamRay* const* rays, const StreamRay::Leg* legs, std::size_t count);
};

const TreeKernels& baseline_tree_kernels();
const TreeKernels& avx2_tree_kernels();  // AVX2 and FMA
const TreeKernels& best_tree_kernels();  // of those that this processor has

}  // namespace meristem
