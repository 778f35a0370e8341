// Attributes of final vertices on a few bytes each: of every vertex of a resident surface there are millions.
#pragma once

#include "geometry/base/vec.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace meristem {

// A unit vector on an octahedron unfolded to a square (Cigolle et al. 2014, "oct32"): within 5e-5 rad. Zero is not
// kept: it comes out as the z axis.
struct PackedNormal {
  static constexpr float largest = 32767;
  std::int16_t x = 0, y = 0;

  static PackedNormal pack(Vec3f n) {
    const float sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
    if (!(sum > 0)) return {};
    float x = n.x / sum, y = n.y / sum;
    if (n.z < 0) {
      const float fx = (1 - std::abs(y)) * std::copysign(1.0f, x);
      y = (1 - std::abs(x)) * std::copysign(1.0f, y);
      x = fx;
    }
    return {std::int16_t(std::lrint(x * largest)), std::int16_t(std::lrint(y * largest))};
  }
  Vec3f unpack() const {
    float u = float(x) / largest, v = float(y) / largest;
    const float z = 1 - std::abs(u) - std::abs(v);
    if (z < 0) {
      const float fu = (1 - std::abs(v)) * std::copysign(1.0f, u);
      v = (1 - std::abs(u)) * std::copysign(1.0f, v);
      u = fu;
    }
    return normalize(Vec3f{u, v, z});
  }
};

// u, v as steps from the least of a surface: within 1/131070 of their range over it.
struct PackedUv {
  std::uint16_t u = 0, v = 0;
};
struct UvFrame {
  Vec2f lower, step;

  // Of values from `low` to `high`.
  static UvFrame over(Vec2f low, Vec2f high) { return {low, {(high.x - low.x) / largest, (high.y - low.y) / largest}}; }
  PackedUv pack(Vec2f uv) const { return {pack(uv.x, lower.x, step.x), pack(uv.y, lower.y, step.y)}; }
  Vec2f unpack(PackedUv p) const { return {lower.x + step.x * float(p.u), lower.y + step.y * float(p.v)}; }

 private:
  static constexpr float largest = 65535;
  static std::uint16_t pack(float x, float low, float step) {
    return step > 0 ? std::uint16_t(std::clamp(std::lrint((x - low) / step), 0L, 65535L)) : std::uint16_t(0);
  }
};

struct PackedAttributes {
  PackedNormal normal;
  PackedUv uv;
};

}  // namespace meristem
