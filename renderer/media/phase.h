// The phase function of Henyey and Greenstein (1941). g in (-1, 1): the mean cosine between the directions of light
// before and after; 0 scatters evenly.
#pragma once

#include "renderer/scene/warps.h"

#include <algorithm>
#include <cmath>

namespace meristem {

// By solid angle: also the pdf of sample_phase().
inline float phase(float g, float cosine) {
  const float d = std::max(1 + g * g - 2 * g * cosine, 1e-7f);
  return (1 - g * g) / (4 * pi_f * d * std::sqrt(d));
}

// A direction after scattering of light that travels along `direction`, unit.
inline Vec3f sample_phase(float g, Vec3f direction, Vec2f random) {
  float cosine = 1 - 2 * random.x;
  if (std::abs(g) > 1e-3f) {
    const float s = (1 - g * g) / (1 + g - 2 * g * random.x);
    cosine = std::clamp((1 + g * g - s * s) / (2 * g), -1.f, 1.f);
  }
  const float sine = std::sqrt(std::max(1 - cosine * cosine, 0.f)), angle = 2 * pi_f * random.y;
  return normalize(Frame(direction).to_world({sine * std::cos(angle), sine * std::sin(angle), cosine}));
}

}  // namespace meristem
