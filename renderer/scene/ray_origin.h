// Where a ray that leaves a surface starts, so that it does not meet the same surface again: the hit's position moved
// along the geometric normal by the bound of its error, then to the next float outwards. No scene-wide epsilon.
// Pharr, Jakob, Humphreys 2023, Physically Based Rendering, section 6.8.6.
#pragma once

#include "geometry/accel/surface.h"

#include <bit>
#include <cstdint>

namespace meristem {

// std::nextafter() of a finite number towards the infinity with the sign of `towards`, inline: every ray that leaves a
// surface asks for three.
inline float next_float(float x, float towards) {
  if (x == 0) return std::copysign(0x1p-149f, towards);
  const auto bits = std::bit_cast<std::uint32_t>(x);
  return std::bit_cast<float>((x > 0) == (towards > 0) ? bits + 1 : bits - 1);
}

inline Vec3f ray_origin(const SurfaceHit& hit, Vec3f direction) {
  const float distance = dot(abs(hit.geometric_normal), hit.position_error);
  const Vec3f normal = dot(direction, hit.geometric_normal) < 0 ? -hit.geometric_normal : hit.geometric_normal;
  const Vec3f offset = normal * distance;
  Vec3f origin = hit.position + offset;
  for (int i = 0; i < 3; ++i)
    if (normal[i] != 0) origin[i] = next_float(origin[i], normal[i]);
  return origin;
}

// From what the ray `before` has met.
inline Ray ray_from(const SurfaceHit& hit, Vec3f direction, const Ray& before, RayClass ray_class) {
  Ray ray;
  ray.origin = ray_origin(hit, direction);
  ray.direction = direction;
  ray.time = before.time;
  ray.ray_class = ray_class;
  ray.origin_class = before.ray_class;
  return ray;
}

}  // namespace meristem
