// VoxelSource: samples on a lattice, wherever they come from (a VDB file, a mesh, an expression), block by block.
#pragma once

#include "geometry/base/transform.h"

#include <array>
#include <cstddef>

namespace meristem {

using VoxelIndex = std::array<int, 3>;

class VoxelSource {
 public:
  static constexpr int block_side = 8, row = block_side + 1;
  static constexpr std::size_t block_values = std::size_t(row) * row * row;
  static constexpr std::size_t max_blocks = std::size_t(1) << 24;         // of the samples' box: 2048^3 samples
  static constexpr std::size_t max_uneven_blocks = std::size_t(1) << 20;  // that are not constant: 3 GB

  virtual ~VoxelSource() = default;
  // Writes the samples origin + [0, 8]^3, z fastest: a block and the first layer of its upper neighbours.
  virtual void read_block(VoxelIndex origin, float* out) const = 0;
  // True only if all samples of the block and that layer are `value`; a quick look that may miss some.
  virtual bool is_constant(VoxelIndex origin, float& value) const = 0;

  Affine3d world_from_index;
  float background = 0;                          // everywhere outside the box of samples
  VoxelIndex lower{0, 0, 0}, upper{-1, -1, -1};  // box of the samples, inclusive; empty by default
};

}  // namespace meristem
