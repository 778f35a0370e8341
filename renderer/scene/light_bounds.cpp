#include "renderer/scene/light_bounds.h"

#include "renderer/scene/warps.h"

namespace meristem {
namespace {

float sine_of(float cosine) { return std::sqrt(std::max(0.f, 1 - cosine * cosine)); }

// The cosine of max(0, a - b) for two angles in [0, pi].
float cos_of_difference(float cos_a, float cos_b) {
  return cos_a > cos_b ? 1 : std::min(1.f, cos_a * cos_b + sine_of(cos_a) * sine_of(cos_b));
}

float angle_between(Vec3f a, Vec3f b) {
  return dot(a, b) < 0 ? pi_f - 2 * std::asin(std::min(1.f, length(a + b) / 2))
                       : 2 * std::asin(std::min(1.f, length(a - b) / 2));
}

}  // namespace

float LightBounds::importance(const Receiver& receiver) const {
  const Vec3f to_receiver = receiver.position - box.center();
  const float radius2 = length_squared(box.size()) / 4, distance2 = length_squared(to_receiver);
  // The sphere around the box is seen under this half angle; from inside, every direction may lead to the light
  const bool outside = distance2 > radius2;
  const float cos_seen = outside ? std::sqrt(1 - radius2 / distance2) : -1;
  const Vec3f direction = distance2 > 0 ? to_receiver / std::sqrt(distance2) : axis;
  float received = 1;
  if (receiver.normal != Vec3f{}) {
    const float cosine = -dot(direction, receiver.normal);
    received = cos_of_difference(cosine, cos_seen);
  }
  float cosine = dot(direction, axis);
  if (two_sided) cosine = std::abs(cosine);
  const float least_angle = cos_of_difference(cos_of_difference(cosine, cos_normals), cos_seen);
  if (!(received > 0) || !(least_angle > cos_leaving)) return 0;
  return power * least_angle * received / std::max({distance2, radius2, 1e-30f});
}

LightBounds united(const LightBounds& a, const LightBounds& b) {
  if (!(a.power > 0)) return b;
  if (!(b.power > 0)) return a;
  LightBounds both = a;
  both.box.extend(b.box);
  both.power = a.power + b.power;
  both.cos_leaving = std::min(a.cos_leaving, b.cos_leaving);
  both.two_sided = a.two_sided || b.two_sided;
  // The smallest cone around both cones of normals
  const float spread_a = std::acos(std::clamp(a.cos_normals, -1.f, 1.f));
  const float spread_b = std::acos(std::clamp(b.cos_normals, -1.f, 1.f));
  const float between = angle_between(a.axis, b.axis);
  if (between + spread_b <= spread_a) return both;
  both.axis = b.axis;
  both.cos_normals = b.cos_normals;
  if (between + spread_a <= spread_b) return both;
  const float spread = (spread_a + between + spread_b) / 2;
  const Vec3f across = b.axis - a.axis * dot(a.axis, b.axis);
  both.cos_normals = -1;
  if (spread >= pi_f || !(length_squared(across) > 0)) return both;
  const float turn = spread - spread_a;
  both.axis = normalize(a.axis * std::cos(turn) + normalize(across) * std::sin(turn));
  both.cos_normals = std::cos(spread) - 1e-6f;
  return both;
}

}  // namespace meristem
