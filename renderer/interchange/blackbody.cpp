#include "renderer/interchange/blackbody.h"

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

// A bell with another width on each side.
double lobe(double wavelength, double middle, double narrow_left, double narrow_right) {
  const double t = (wavelength - middle) * (wavelength < middle ? narrow_left : narrow_right);
  return std::exp(-0.5 * t * t);
}

Vec3d observer(double nm) {
  return {1.056 * lobe(nm, 599.8, 0.0264, 0.0323) + 0.362 * lobe(nm, 442.0, 0.0624, 0.0374) -
              0.065 * lobe(nm, 501.1, 0.0490, 0.0382),
          0.821 * lobe(nm, 568.8, 0.0213, 0.0247) + 0.286 * lobe(nm, 530.9, 0.0613, 0.0322),
          1.217 * lobe(nm, 437.0, 0.0845, 0.0278) + 0.681 * lobe(nm, 459.0, 0.0385, 0.0725)};
}

}  // namespace

Vec3d blackbody_color(double kelvin) {
  const double temperature = std::clamp(kelvin, 500.0, 40000.0);
  Vec3d xyz{};
  for (double nm = 380; nm <= 780; nm += 5) {
    constexpr double second_radiation_constant = 1.438777e7;  // nm K
    const double radiance = std::pow(nm / 560, -5) / std::expm1(second_radiation_constant / (nm * temperature));
    xyz += observer(nm) * radiance;
  }
  xyz = xyz / xyz.y;
  const Vec3d rgb{3.2404542 * xyz.x - 1.5371385 * xyz.y - 0.4985314 * xyz.z,
                  -0.9692660 * xyz.x + 1.8760108 * xyz.y + 0.0415560 * xyz.z,
                  0.0556434 * xyz.x - 0.2040259 * xyz.y + 1.0572252 * xyz.z};
  return {std::max(rgb.x, 0.0), std::max(rgb.y, 0.0), std::max(rgb.z, 0.0)};
}

}  // namespace meristem
