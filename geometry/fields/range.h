// Range: an interval in double, and what the bounds of expressions compute with.
#pragma once

#include "geometry/fields/interval.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace meristem::bounds {

inline constexpr double largest = std::numeric_limits<float>::max();
inline constexpr double smallest = std::numeric_limits<float>::min();  // below it numbers are flushed to 0
inline constexpr double infinity = std::numeric_limits<double>::infinity();

// An interval in double, in which products and sums of floats neither overflow nor lose what matters.
struct Range {
  double lower = 0, upper = 0;

  bool contains(double v) const { return lower <= v && v <= upper; }
  double magnitude() const { return std::max(std::abs(lower), std::abs(upper)); }
};

inline Range range_of(Interval i) { return {i.lower, i.upper}; }
inline Interval interval_of(Range r) { return {float(r.lower), float(r.upper)}; }  // of floats
inline Range hull(Range a, Range b) { return {std::min(a.lower, b.lower), std::max(a.upper, b.upper)}; }
inline Range clipped(Range r, double lower, double upper) {
  return {std::clamp(r.lower, lower, upper), std::clamp(r.upper, lower, upper)};
}
inline Range clipped(Range r, Range to) { return clipped(r, to.lower, to.upper); }

// The next float of one that is finite, upwards.
inline float next_up(float f) {
  if (f == 0) return std::numeric_limits<float>::denorm_min();
  return std::bit_cast<float>(std::bit_cast<std::int32_t>(f) + (f > 0 ? 1 : -1));
}
inline float next_down(float f) { return -next_up(-f); }

// The floats that an operation with this exact range may give: 4 ulps further, flushed denormals, saturated.
inline Range rounded(Range r) {
  auto margin = [](double v) { return std::abs(v) * 0x1p-21 + 2 * smallest; };
  auto down = [](double v) {
    const float f = float(v);
    return double(f) <= v ? f : next_down(f);
  };
  auto up = [](double v) {
    const float f = float(v);
    return double(f) >= v ? f : next_up(f);
  };
  return {down(std::clamp(r.lower - margin(r.lower), -largest, largest)),
          up(std::clamp(r.upper + margin(r.upper), -largest, largest))};
}

inline Range add(Range a, Range b) { return {a.lower + b.lower, a.upper + b.upper}; }
inline Range subtract(Range a, Range b) { return {a.lower - b.upper, a.upper - b.lower}; }
inline Range multiply(Range a, Range b) {
  const auto [least, most] = std::minmax({a.lower * b.lower, a.lower * b.upper, a.upper * b.lower, a.upper * b.upper});
  return {least, most};
}
inline Range absolute(Range a) {
  if (a.lower >= 0) return a;
  if (a.upper <= 0) return {-a.upper, -a.lower};
  return {0, a.magnitude()};
}

using Box = std::array<Range, 3>;

}  // namespace meristem::bounds
