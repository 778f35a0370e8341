// A footprint that grows with the distance from a point, as that of a camera does.
#pragma once

#include "geometry/cells/footprint.h"

#include <algorithm>

namespace meristem {

class PointFootprint final : public Footprint {
 public:
  PointFootprint(Vec3d eye, double pixel, bool fades = false) : eye_(eye), pixel_(pixel), fades_(fades) {}
  double at(Vec3d position) const override { return pixel_ * length(position - eye_) + 1e-9; }
  Range range(const Bounds3d& box) const override {
    const double middle = length(box.center() - eye_), radius = box.diagonal() / 2;
    return {pixel_ * std::max(0.0, middle - radius), pixel_ * (middle + radius) + 2e-9};
  }
  bool fades() const override { return fades_; }

 private:
  const Vec3d eye_;
  const double pixel_;
  const bool fades_;
};

}  // namespace meristem
