#include "geometry/cells/footprint.h"

#include <algorithm>
#include <cmath>

namespace meristem {

ObjectFootprint::ObjectFootprint(std::shared_ptr<const Footprint> parent, const Affine3d& to_parent)
    : parent_(std::move(parent)), to_parent_(to_parent), stretch_(largest_stretch(to_parent)) {}

// The largest singular value is at most the root of the largest absolute row sum of the Gram matrix.
double largest_stretch(const Affine3d& m) {
  const double xy = std::abs(dot(m.x, m.y)), xz = std::abs(dot(m.x, m.z)), yz = std::abs(dot(m.y, m.z));
  return std::sqrt(
      std::max({length_squared(m.x) + xy + xz, length_squared(m.y) + xy + yz, length_squared(m.z) + xz + yz}));
}

}  // namespace meristem
