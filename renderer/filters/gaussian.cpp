// gaussian: a bell without negative lobes, lowered to reach zero at its radius. Soft, never rings.
#include "renderer/scene/interfaces.h"

namespace meristem {
namespace {

class Gaussian : public Filter {
 public:
  explicit Gaussian(Params& params) {
    radius_ = params.real("radius", 1.5, {0.01, 32, "px"}, "half the width");
    sigma_ = params.real("sigma", 0.5, {0.01, 32, "px"}, "standard deviation before the cut");
    edge_ = bell(radius_);
    const double bell_area = sigma_ * std::sqrt(2 * pi) * std::erf(radius_ / (sigma_ * std::sqrt(2.0)));
    scale_ = 1 / (bell_area - 2 * radius_ * edge_);
  }

  float radius() const override { return float(radius_); }
  float value(float x) const override { return float(std::max(0.0, bell(x) - edge_) * scale_); }

 private:
  double bell(double x) const { return std::exp(-x * x / (2 * sigma_ * sigma_)); }

  double radius_, sigma_;
  double edge_;   // bell(radius_)
  double scale_;  // so that the integral is 1
};

}  // namespace

void register_gaussian(FilterRegistry& r) { r.add<Gaussian>("gaussian", "A bell without negative lobes"); }

}  // namespace meristem
