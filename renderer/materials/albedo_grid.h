// What the tables of directional albedos share: places on their axes, and Gauss's rule for their integrals.
//
// An axis is even in a root of what it holds, which evens out where albedos change fast: the fourth root of alpha, the
// fourth root of f0, the root of the cosine.
#pragma once

#include "renderer/materials/ggx.h"

#include <algorithm>
#include <cmath>

namespace meristem::ggx {

inline float mix(float a, float b, float t) { return a + (b - a) * t; }

// A function on [0, 1] at `count` even places, as index and fraction for linear interpolation.
struct Place {
  int index;
  float fraction;
  Place(float x, int count) {
    const float f = std::clamp(x, 0.f, 1.f) * float(count - 1);
    index = std::min(int(f), count - 2);
    fraction = f - float(index);
  }
};

// Step i of `count` of the fourth root of alpha, from min_alpha to 1.
inline float alpha_at(int i, int count) {
  return std::pow(mix(std::pow(min_alpha, 0.25f), 1, float(i) / float(count - 1)), 4.f);
}
inline Place place_of_alpha(float alpha, int count) {
  const float least = std::sqrt(std::sqrt(min_alpha));
  return {(std::sqrt(std::sqrt(alpha)) - least) / (1 - least), count};
}

// Step i of the fourth root of f0, from 0 to max_f0. Between steps albedos are about linear in the logarithm of that,
// since at grazing angles a Fresnel term is a function of the cosine over it.
inline float f0_at(int i, int count) { return std::pow(float(i) / float(count - 1), 4.f) * max_f0; }
inline Place place_of_f0(float f0, int count) {
  Place p(std::sqrt(std::sqrt(std::clamp(f0 / max_f0, 0.f, 1.f))), count);
  p.fraction *= 1 + (1 - p.fraction) / (2 * (float(p.index) + p.fraction) + 1);
  return p;
}

inline Place place_of_cosine(float c, int count) { return {std::sqrt(std::max(c, 0.f)), count}; }

// The rule of Gauss and Legendre on [0, 1].
constexpr int rule_size = 8;
constexpr float rule_at[rule_size] = {0.01985507f, 0.10166676f, 0.23723380f, 0.40828268f,
                                      0.59171732f, 0.76276620f, 0.89833324f, 0.98014493f};
constexpr float rule_weight[rule_size] = {0.05061427f, 0.11119052f, 0.15685332f, 0.18134189f,
                                          0.18134189f, 0.15685332f, 0.11119052f, 0.05061427f};

// Its nodes crowded at both ends of [from, to], which evens out roots with which a function begins or ends there.
struct CrowdedNode {
  float at, weight;
  CrowdedNode(int k, float from, float to) {
    const float x = rule_at[k];
    at = from + (to - from) * x * x * (3 - 2 * x);
    weight = rule_weight[k] * (to - from) * 6 * x * (1 - x);
  }
};

}  // namespace meristem::ggx
