// Frames of stems: columns x, y, z and an origin; z runs along the stem, and y points to the sky where a stem is level.
// Small pure functions; the same numbers give the same bits.
#pragma once

#include "geometry/base/key.h"
#include "geometry/base/transform.h"

#include <algorithm>

namespace meristem {

constexpr double to_radians(double degrees) { return degrees * (pi / 180); }
constexpr double to_degrees(double radians) { return radians * (180 / pi); }

// Up in the model's space, the z of the paper's trees.
inline const Vec3d plant_up{0, 1, 0};

// About the frame's own x axis: z leans towards -y for positive angles.
inline void turn_about_x(Affine3d& f, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const Vec3d y = f.y, z = f.z;
  f.y = y * c + z * s;
  f.z = z * c - y * s;
}
inline void turn_about_y(Affine3d& f, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const Vec3d x = f.x, z = f.z;
  f.x = x * c - z * s;
  f.z = z * c + x * s;
}
inline void turn_about_z(Affine3d& f, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const Vec3d x = f.x, y = f.y;
  f.x = x * c + y * s;
  f.y = y * c - x * s;
}
// About an axis of the model's space; the origin stays.
inline void turn_about(Affine3d& f, Vec3d axis, double angle) {
  const Affine3d turn = Affine3d::rotation(axis, angle);
  f.x = turn.vector(f.x);
  f.y = turn.vector(f.y);
  f.z = turn.vector(f.z);
}
// About the vertical.
inline void turn_about_up(Affine3d& f, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  for (Vec3d* v : {&f.x, &f.y, &f.z}) *v = {v->x * c + v->z * s, v->y, v->z * c - v->x * s};
}
// The least turn that leads z to the unit vector `to`, which does not point against it.
inline void lead_to(Affine3d& f, Vec3d to) {
  const Vec3d axis = cross(f.z, to);  // as long as the sine
  const double cosine = dot(f.z, to);
  if (1 + cosine < 1e-9) return;
  const auto turn = [&](Vec3d v) { return v * cosine + cross(axis, v) + axis * (dot(axis, v) / (1 + cosine)); };
  f.x = turn(f.x);
  f.y = turn(f.y);
  f.z = to;
}

// The angle to the vertical, radians.
inline double declination(Vec3d z) { return std::acos(std::clamp(dot(z, plant_up), -1.0, 1.0)); }

// Random numbers of one thing (a stem, a leaf) by what they are for.
class Draws {
 public:
  explicit Draws(Key key) : keys_(key) {}
  // Many draws of one kind are numbered.
  Draws of(Key what) const { return Draws(keys_(what)); }
  double uniform(Key what) const { return uniform_double(keys_(what)); }
  double uniform(Key what, Key index) const { return of(what).uniform(index); }
  // In +-v.
  double spread(double v, Key what) const { return v == 0 ? 0 : v * (2 * uniform(what) - 1); }
  double spread(double v, Key what, Key index) const { return v == 0 ? 0 : of(what).spread(v, index); }

 private:
  KeysFrom keys_;
};

}  // namespace meristem
