// Kernels that place the children of a stem, in three builds as those of the expression language
// (geometry/fields/kernels.h): a child has the same bits with each, wherever it stands in its rows. No library's sine
// takes part, so a tree is the same on every machine. Any thread.
#pragma once

#include "procedural/plants/child_rows.h"

namespace meristem {

struct StemNode;

// The vertices of leaves of one shape and size, in the frame of a leaf.
struct LeafVertices {
  const Vec3d* vertices;
  std::size_t count;
  double forward;  // how far leaves are moved along their z
  double magic;    // of the grid of positions
};

struct ChildKernels {
  // Puts children on the axis from joint a to joint b, at their part of it; their frames are those of the axis there.
  void (*put_on_axis)(const StemNode& a, const StemNode& b, ChildRows::View rows, std::size_t begin, std::size_t end);
  // Turns frames about their z, around the stem, and then about their x, away from it.
  void (*turn_away)(ChildRows::View rows, std::size_t count);
  // Turns leaves towards the light: outwards and upwards (section 4.9 of the paper).
  void (*turn_to_light)(ChildRows::View rows, std::size_t count, double bend);
  // Where the vertices of a group of leaves are, from `first` on: coordinate c of vertex v of leaf `first` + i is
  // out[(3 v + c) group + i].
  void (*put_vertices)(ChildRows::View rows, std::size_t first, const LeafVertices& vertices, double* out);
};

const ChildKernels& baseline_child_kernels();
const ChildKernels& avx2_child_kernels();
const ChildKernels& avx512_child_kernels();
const ChildKernels& best_child_kernels();  // of those that this machine can run

}  // namespace meristem
