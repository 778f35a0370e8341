// BrickGrid: samples in memory as a Grid. Bricks of 8^3 samples with one layer of their upper neighbours, so that the
// eight samples around any place lie in one brick; constant bricks are one number. A pyramid of smallest and largest
// values over the bricks answers for boxes.
//
// Measured against NanoVDB's and OpenVDB's samplers: docs/decisions/images.md.
#pragma once

#include "geometry/fields/grid.h"
#include "geometry/volumes/voxel_source.h"

#include <cstdint>
#include <vector>

namespace meristem {

class BrickGrid final : public Grid {
 public:
  // Throws a std::runtime_error if the source exceeds the limits of a VoxelSource or a sample is not finite.
  explicit BrickGrid(const VoxelSource& source);

  float value(Vec3f place) const override;
  Vec3f gradient(Vec3f place) const override;
  Interval value_bounds(const Bounds3d& box) const override;
  Interval gradient_bounds(const Bounds3d& box) const override;

  // Outside it there is background alone; empty if there are no samples.
  Bounds3d bounds() const;
  double spacing() const { return spacing_; }  // of the samples, in the mean of the axes
  std::size_t bytes() const;

 private:
  struct Level {  // of the pyramid: the bricks, then cells of 2^3 of the level before
    VoxelIndex size;
    std::vector<Interval> cells;
  };

  void read(const VoxelSource& source);
  Interval add_brick(const VoxelSource& source, std::size_t index, VoxelIndex origin);
  void build_pyramid();
  std::size_t cell(const Level& level, int x, int y, int z) const {
    return (std::size_t(x) * std::size_t(level.size[1]) + std::size_t(y)) * std::size_t(level.size[2]) + std::size_t(z);
  }
  float sample(int x, int y, int z) const;
  Interval exact_bounds(VoxelIndex first, VoxelIndex last) const;
  Interval pyramid_bounds(VoxelIndex first, VoxelIndex last) const;

  Affine3d index_from_world_, world_from_index_;
  double spacing_ = 1;
  float background_ = 0;
  VoxelIndex lower_, upper_;  // cells between samples that are interpolated: from the first to the last, inclusive
  VoxelIndex base_;           // the first brick's origin
  // By brick: the first of its values in values_, or, from constant_bit on, an index into constants_.
  static constexpr std::uint32_t constant_bit = 0x80000000u;
  std::vector<std::uint32_t> directory_;
  std::vector<float> values_, constants_;
  std::vector<Level> pyramid_;
};

}  // namespace meristem
