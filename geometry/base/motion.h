// Motion: an affine map that changes while the shutter is open. Immutable; any thread.
#pragma once

#include "geometry/base/transform.h"

#include <algorithm>
#include <vector>

namespace meristem {

struct Motion {
  // At equidistant times, from the opening of the shutter to its closing; at least two.
  std::vector<Affine3d> keys;

  // At a time from 0 to 1 of the shutter. Linear between keys: a point goes from each to the next on a straight line,
  // so it stays in every box that holds it at both.
  Affine3d at(float time) const {
    const double place = std::clamp(double(time), 0.0, 1.0) * double(keys.size() - 1);
    const std::size_t i = std::min(std::size_t(place), keys.size() - 2);
    const double b = place - double(i), a = 1 - b;
    const Affine3d &from = keys[i], &to = keys[i + 1];
    return {from.x * a + to.x * b, from.y * a + to.y * b, from.z * a + to.z * b, from.origin * a + to.origin * b};
  }

  // Holds whatever moves in a box, at all times.
  Bounds3d bounds(const Bounds3d& b) const {
    Bounds3d result;
    for (const Affine3d& key : keys) result.extend(key.bounds(b));
    return result;
  }
};

}  // namespace meristem
