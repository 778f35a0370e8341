// A footprint that grows with the distance from a point, as that of a camera does.
#pragma once

#include "geometry/cells/footprint.h"

namespace meristem {

class PointFootprint final : public Footprint {
 public:
  PointFootprint(Vec3d eye, double pixel) : eye_(eye), pixel_(pixel) {}
  double at(Vec3d position) const override { return pixel_ * length(position - eye_) + 1e-9; }

 private:
  const Vec3d eye_;
  const double pixel_;
};

}  // namespace meristem
