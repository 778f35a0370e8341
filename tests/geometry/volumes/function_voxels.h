// Samples of a function, for tests.
#pragma once

#include "geometry/volumes/voxel_source.h"

#include <functional>

namespace meristem::test {

class FunctionVoxels final : public VoxelSource {
 public:
  FunctionVoxels(VoxelIndex first, VoxelIndex last, std::function<float(int, int, int)> f) : f_(std::move(f)) {
    lower = first;
    upper = last;
  }
  float at(int x, int y, int z) const {
    const bool inside =
        x >= lower[0] && y >= lower[1] && z >= lower[2] && x <= upper[0] && y <= upper[1] && z <= upper[2];
    return inside ? f_(x, y, z) : background;
  }
  void read_block(VoxelIndex o, float* out) const override {
    for (int x = 0; x < row; ++x)
      for (int y = 0; y < row; ++y)
        for (int z = 0; z < row; ++z) *out++ = at(o[0] + x, o[1] + y, o[2] + z);
  }
  bool is_constant(VoxelIndex, float&) const override { return false; }

 private:
  std::function<float(int, int, int)> f_;
};

}  // namespace meristem::test
