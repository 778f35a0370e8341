// FaceBlocks: a mesh by cubes of so many edges of its first face, which on an even ground hold the same square of faces
// each, so that cells of them have one shape.
#pragma once

#include "geometry/mesh/mesh.h"

#include <array>
#include <cstdint>

namespace meristem {

using FaceBlock = std::array<std::int64_t, 3>;

class FaceBlocks {
 public:
  // The mesh must outlive it, and have a face.
  FaceBlocks(const Mesh& mesh, double edges);
  // Where the centroid of a face lies.
  FaceBlock of(std::uint32_t face) const;

 private:
  const Mesh& mesh_;
  const Vec3d origin_;
  const double scale_;  // to blocks
};

}  // namespace meristem
