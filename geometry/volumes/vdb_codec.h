// VdbCodec: what needs OpenVDB, behind a module that is opened at first use (geometry/base/module.h): linked to the
// program it would cost every start some milliseconds of dynamic linking (docs/decisions/images.md).
#pragma once

#include "geometry/base/vec.h"
#include "geometry/volumes/voxel_source.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace meristem {

enum class GridClass { LevelSet, Fog };

// Errors are std::runtime_errors without the file's name.
class VdbCodec {
 public:
  // The grid of floats called `grid` (empty: the first) of a regular file. What the file says of its size is checked
  // against the limits of a VoxelSource before its samples are read.
  virtual std::unique_ptr<VoxelSource> read(const std::string& path, const std::string& grid) const = 0;
  // The signed distance from a closed mesh, negative inside, within `band` samples of it. Same bits at every call if
  // the caller's TBB arena has one thread.
  virtual std::unique_ptr<VoxelSource> level_set(std::span<const Vec3f> vertices,
                                                 std::span<const std::array<std::uint32_t, 3>> triangles,
                                                 double spacing, double band) const = 0;
  // The bytes of a file with one grid.
  virtual std::string encode(const VoxelSource& voxels, const std::string& grid, GridClass grid_class) const = 0;

 protected:
  ~VdbCodec() = default;
};

// Opens the module at the first call; it stays open. Any thread; throws a std::runtime_error that names the module.
const VdbCodec& vdb_codec();

}  // namespace meristem

// What the module exports. Never null; lives as long as the module.
extern "C" const meristem::VdbCodec* meristem_vdb_codec();
