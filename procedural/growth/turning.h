// Turns of a face's frame: how a template leads the axis of a stem on. Pure functions, no state; the same numbers give
// the same bits.
#pragma once

#include "geometry/base/transform.h"
#include "geometry/mesh/mesh.h"

#include <algorithm>

namespace meristem {

constexpr double radians(double degrees) { return degrees * (pi / 180); }

// The unit vector in the face's plane at an angle (radians) from its x axis, counter-clockwise seen from outside.
inline Vec3d plane_direction(const FaceFrame& frame, double angle) {
  return frame.x * std::cos(angle) + frame.y * std::sin(angle);
}

// The turn that leads the unit vector `axis` towards the direction `target` as a stem follows light or weight:
// by strength * sin(angle between) radians, but not beyond it (Prusinkiewicz, Lindenmayer 1990, section 2.1 "tropism":
// alpha = e |H x T|). Negative strengths turn away.
inline Affine3d tropism_turn(Vec3d axis, Vec3d target, double strength) {
  const Vec3d t = normalize(target), around = cross(axis, t);
  const double sine = length(around);
  if (strength == 0 || sine == 0) return {};
  const double between = std::atan2(sine, dot(axis, t));
  return Affine3d::rotation(around / sine, std::clamp(strength * sine, between - pi, between));
}

// Leans the frame's normal by an angle (radians) towards a unit direction of its plane.
inline Affine3d lean(const FaceFrame& frame, Vec3d towards, double angle) {
  return angle == 0 ? Affine3d{} : Affine3d::rotation(cross(frame.z, towards), angle);
}

}  // namespace meristem
