// NodeWriter: a node of a tree as it is filled.
#pragma once

#include "geometry/tree/surface_tree.h"
#include "geometry/tree/tree_items.h"

#include <algorithm>
#include <cmath>

namespace meristem::tree {

class NodeWriter {
 public:
  explicit NodeWriter(const Box& box) : node_{} {
    _mm_store_ps(lower_, box.lower);
    alignas(16) float upper[4];
    _mm_store_ps(upper, box.upper);
    node_.grid = SurfaceTree::none;
    for (int axis = 0; axis < 3; ++axis) {
      node_.origin[axis] = lower_[axis];
      // The least power of two of which 255 steps are enough.
      const double size = double(upper[axis]) - double(lower_[axis]);
      const int exponent = size > 0 ? std::clamp(std::ilogb(size / 255) + 1, -126, 127) : -126;
      node_.exponent[axis] = std::uint8_t(exponent + 127);
      steps_[axis] = std::ldexp(1.0, -exponent);
    }
  }

  void add(const Box& box, std::uint32_t first, std::uint32_t stride, std::uint32_t shape) {
    const int child = node_.children++;
    alignas(16) float lower[4], upper[4];
    _mm_store_ps(lower, box.lower);
    _mm_store_ps(upper, box.upper);
    for (int axis = 0; axis < 3; ++axis) {
      const auto place = [&](float x) { return (double(x) - double(lower_[axis])) * steps_[axis]; };
      node_.bounds[axis][0][child] = std::uint8_t(place(lower[axis]));
      node_.bounds[axis][1][child] = std::uint8_t(std::ceil(place(upper[axis])));
    }
    node_.first[child] = first;
    node_.stride[child] = std::uint16_t(stride);
    node_.shape[child] = std::uint8_t(shape);
  }
  // All grids before the first of their quads.
  void add_grid(std::uint32_t grid) { node_.grid = std::min(node_.grid, grid); }
  void add_quads(const Box& box, const Source& quads) {
    node_.grids_further |= std::min(quads.grid - node_.grid, 15u) << (4 * node_.children);
    add(box, quads.first, quads.stride, quads.columns + 16u * quads.rows);
  }
  void add_node(const Box& box, std::size_t index) { add(box, std::uint32_t(index), 0, 0); }
  const SurfaceTree::Node& node() const { return node_; }

 private:
  SurfaceTree::Node node_;
  alignas(16) float lower_[4];
  double steps_[3];
};

}  // namespace meristem::tree
