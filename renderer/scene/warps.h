// Warps: maps from uniform numbers in [0, 1)^2 to directions, and what goes with sampling them. Pure; any thread.
// Directions are in a local frame with z along the axis.
#pragma once

#include "geometry/base/vec.h"

namespace meristem {

constexpr float pi_f = float(pi);

// An orthonormal frame around a unit axis n.
struct Frame {
  Vec3f s{1, 0, 0}, t{0, 1, 0}, n{0, 0, 1};

  Frame() = default;
  explicit Frame(Vec3f axis) : n(axis) { orthonormal_basis(n, s, t); }
  Vec3f to_world(Vec3f v) const { return s * v.x + t * v.y + n * v.z; }
  Vec3f to_local(Vec3f v) const { return {dot(s, v), dot(t, v), dot(n, v)}; }
};

// (cos, sin) of an angle in [-pi/4, pi/4], within 1e-7: the polynomials of Moshier's Cephes library.
inline Vec2f cos_sin_of_octant(float angle) {
  const float x = angle * angle;
  return {1 - 0.5f * x + x * x * (4.166664568e-2f + x * (-1.388731625e-3f + x * 2.443315712e-5f)),
          angle + angle * x * (-1.6666654611e-1f + x * (8.3321608736e-3f + x * -1.9515295891e-4f))};
}

// The unit disk, uniformly by area. Shirley and Chiu 1997, "A Low Distortion Map Between Disk and Square".
inline Vec2f concentric_disk(Vec2f random) {
  const float a = 2 * random.x - 1, b = 2 * random.y - 1;
  if (a == 0 && b == 0) return {0, 0};
  const bool wide = std::abs(a) > std::abs(b);
  const float radius = wide ? a : b, other = wide ? b : a;
  const Vec2f d = cos_sin_of_octant(pi_f / 4 * (other / radius));
  return wide ? Vec2f{radius * d.x, radius * d.y} : Vec2f{radius * d.y, radius * d.x};
}

// The hemisphere with pdf z / pi (Malley's method).
inline Vec3f cosine_hemisphere(Vec2f random) {
  const Vec2f d = concentric_disk(random);
  return {d.x, d.y, std::sqrt(std::max(0.f, 1 - d.x * d.x - d.y * d.y))};
}

// A cone around z, uniformly by solid angle. Its width is given as 1 - cos(half angle), which keeps its digits when the
// cone is as narrow as the sun's; 1 is the hemisphere, 2 the sphere.
inline Vec3f uniform_cone(float one_minus_cos, Vec2f random) {
  const float c = random.x * one_minus_cos, angle = 2 * pi_f * random.y;
  const float sine = std::sqrt(std::max(0.f, c * (2 - c)));
  return {sine * std::cos(angle), sine * std::sin(angle), 1 - c};
}
inline float uniform_cone_pdf(float one_minus_cos) { return 1 / (2 * pi_f * one_minus_cos); }

// 1 - cos of the angle between two unit vectors, with all digits for small angles.
inline float one_minus_cosine(Vec3f a, Vec3f b) { return 0.5f * length_squared(a - b); }

// The weight of a sample from the first of two strategies: the power heuristic with exponent 2, Veach 1997, section
// 9.2.
inline float power_heuristic(float pdf, float other_pdf) {
  if (!(pdf > 0)) return 0;
  const float ratio = other_pdf / pdf;
  return 1 / (1 + ratio * ratio);
}

}  // namespace meristem
