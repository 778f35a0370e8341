// blackman_harris: a smooth bell with side lobes 92 dB down in frequency: no ringing, little blur, never negative.
// Harris 1978, "On the Use of Windows for Harmonic Analysis", the four-term window of table 1.
#include "renderer/scene/interfaces.h"

namespace meristem {
namespace {

class BlackmanHarris : public Filter {
 public:
  explicit BlackmanHarris(Params& params) { radius_ = params.real("radius", 1.5, {0.01, 32, "px"}, "half the width"); }

  float radius() const override { return float(radius_); }
  float value(float x) const override {
    if (std::abs(x) >= radius_) return 0;
    const double t = pi * x / radius_;
    const double window = 0.35875 + 0.48829 * std::cos(t) + 0.14128 * std::cos(2 * t) + 0.01168 * std::cos(3 * t);
    return float(window / (0.35875 * 2 * radius_));  // the cosines cancel over the whole width
  }

 private:
  double radius_;
};

}  // namespace

void register_blackman_harris(FilterRegistry& r) {
  r.add<BlackmanHarris>("blackman_harris", "A smooth bell: the default");
}

}  // namespace meristem
