// mitchell: a piecewise cubic that trades blur (b) against ringing (c); its lobes are slightly negative.
// Mitchell and Netravali 1988, "Reconstruction Filters in Computer Graphics", equation 8.
#include "renderer/scene/interfaces.h"

namespace meristem {
namespace {

class Mitchell : public Filter {
 public:
  explicit Mitchell(Params& params) {
    radius_ = params.real("radius", 2, {0.01, 32, "px"}, "half the width");
    b_ = params.real("b", 1.0 / 3, unit_range, "blur: 1 is the cubic B-spline");
    c_ = params.real("c", 1.0 / 3, unit_range, "sharpening: b = 0, c = 0.5 is the Catmull-Rom spline");
  }

  float radius() const override { return float(radius_); }
  float value(float x) const override {
    const double stretch = 2 / radius_;
    return float(cubic(std::abs(double(x)) * stretch) * stretch);
  }

 private:
  // On [0, 2]; its integral over [-2, 2] is 1 for every b and c.
  double cubic(double x) const {
    if (x >= 2) return 0;
    if (x >= 1)
      return (((-b_ - 6 * c_) * x + 6 * b_ + 30 * c_) * x * x + (-12 * b_ - 48 * c_) * x + 8 * b_ + 24 * c_) / 6;
    return (((12 - 9 * b_ - 6 * c_) * x - 18 + 12 * b_ + 6 * c_) * x * x + 6 - 2 * b_) / 6;
  }

  double radius_, b_, c_;
};

}  // namespace

void register_mitchell(FilterRegistry& r) { r.add<Mitchell>("mitchell", "The cubic of Mitchell and Netravali"); }

}  // namespace meristem
