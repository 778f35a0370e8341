#include "geometry/cells/face_blocks.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meristem {

FaceBlocks::FaceBlocks(const Mesh& mesh, double edges)
    : mesh_(mesh),
      origin_(mesh.positions[mesh.corners(0)[0]]),
      scale_(1 / std::max(length(mesh.positions[mesh.corners(0)[1]] - origin_) * edges,
                          std::numeric_limits<double>::min())) {}

FaceBlock FaceBlocks::of(std::uint32_t face) const {
  const auto corners = mesh_.corners(face);
  Vec3d centroid;
  for (std::uint32_t v : corners) centroid += mesh_.positions[v];
  const Vec3d at = (centroid / double(corners.size()) - origin_) * scale_;
  const auto step = [](double x) { return std::int64_t(std::floor(std::clamp(x, -1e15, 1e15))); };
  return {step(at.x), step(at.y), step(at.z)};
}

}  // namespace meristem
