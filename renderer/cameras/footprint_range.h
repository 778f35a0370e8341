// FootprintRange: what a camera may know of its footprint beside that of single points.
#pragma once

#include "geometry/base/vec.h"

#include <utility>

namespace meristem {

class FootprintRange {
 public:
  virtual ~FootprintRange() = default;
  // Bounds on Camera::footprint() in a sphere, the lower first; from 0 to infinity where they are not known. Any
  // thread.
  virtual std::pair<float, float> footprint_range(Vec3f center, float radius, int width, int height) const = 0;
};

}  // namespace meristem
