// Builds a SurfaceTree, eight parts a node.
#pragma once

#include "geometry/tree/surface_tree.h"

namespace meristem {

struct BuiltTree {
  std::vector<SurfaceTree::Node> nodes;  // the root first
  std::vector<std::uint32_t> triangles;  // of the tessellation's list, in the order in which blocks want them
};

// Fills `built`, whose memory is used again. The same for any number of threads. Some 20 ns a quad. `parallel`: large
// ones by parallel_for().
void build_tree(const Tessellation& tessellation, bool parallel, BuiltTree& built);

}  // namespace meristem
