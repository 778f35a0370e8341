#include "geometry/tree/surface_tree.h"

#include <cmath>

namespace meristem {

namespace {

// A direction along an axis is taken as this much of the longest at least, so that its reciprocal is finite.
constexpr float least_share = 1e-20f;

// Of the plane of a box: its distance, the reciprocal, their product, that of the step, and the sum each round, 2^-24
// relative to distance and size of the node; the rest is for the t of a hit, which has rounded as well.
constexpr float slack_of_plane = 0x1p-20f;

}  // namespace

TreeRay::TreeRay(Vec3f o, Vec3f d) : origin{o.x, o.y, o.z, 0} {
  const Vec3f magnitude = abs(d);
  axis = magnitude.x >= magnitude.y ? (magnitude.x >= magnitude.z ? 0 : 2) : (magnitude.y >= magnitude.z ? 1 : 2);
  const float least = magnitude[axis] * least_share;
  for (int i = 0; i < 3; ++i) {
    reciprocal[i] = 1 / (magnitude[i] >= least ? d[i] : std::copysign(least, d[i]));
    slack[i] = std::abs(reciprocal[i]) * slack_of_plane;
    near_side[i] = std::signbit(d[i]);
  }
  reciprocal[3] = slack[3] = 0;
  shear_x = d[(axis + 1) % 3] / d[axis];
  shear_y = d[(axis + 2) % 3] / d[axis];
  shear_z = 1 / d[axis];
}

}  // namespace meristem
