// Affine3: an affine map of 3-space as three columns and a translation. Points, vectors and normals transform apart.
#pragma once

#include "geometry/base/bounds.h"

namespace meristem {

template <class T>
struct Affine3 {
  Vec3<T> x{T(1), T(0), T(0)}, y{T(0), T(1), T(0)}, z{T(0), T(0), T(1)};  // images of the axes
  Vec3<T> origin{};

  Vec3<T> vector(Vec3<T> v) const { return x * v.x + y * v.y + z * v.z; }
  Vec3<T> point(Vec3<T> p) const { return vector(p) + origin; }
  bool is_identity() const { return *this == Affine3{}; }
  bool operator==(const Affine3&) const = default;

  // (a * b).point(p) == a.point(b.point(p))
  Affine3 operator*(const Affine3& b) const { return {vector(b.x), vector(b.y), vector(b.z), point(b.origin)}; }

  T determinant() const { return dot(x, cross(y, z)); }
  // The inverse map. Needs determinant() != 0.
  Affine3 inverse() const {
    const T d = T(1) / determinant();
    const Vec3<T> r0 = cross(y, z) * d, r1 = cross(z, x) * d, r2 = cross(x, y) * d;  // rows
    Affine3 m{{r0.x, r1.x, r2.x}, {r0.y, r1.y, r2.y}, {r0.z, r1.z, r2.z}, {}};
    m.origin = -m.vector(origin);
    return m;
  }
  // The transpose applied to v: transforms normals when called on the inverse.
  Vec3<T> transposed_vector(Vec3<T> v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }

  Bounds3<T> bounds(const Bounds3<T>& b) const {
    Bounds3<T> r;
    for (int i = 0; i < 8; ++i)
      r.extend(point({i & 1 ? b.upper.x : b.lower.x, i & 2 ? b.upper.y : b.lower.y, i & 4 ? b.upper.z : b.lower.z}));
    return r;
  }

  static Affine3 translation(Vec3<T> t) {
    Affine3 m;
    m.origin = t;
    return m;
  }
  static Affine3 scaling(Vec3<T> s) { return {{s.x, T(0), T(0)}, {T(0), s.y, T(0)}, {T(0), T(0), s.z}, {}}; }
  // Rotation about a unit axis by an angle in radians, counter-clockwise seen against the axis.
  static Affine3 rotation(Vec3<T> axis, T angle) {
    const T c = std::cos(angle), s = std::sin(angle);
    auto turn = [&](Vec3<T> v) { return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (T(1) - c)); };
    return {turn({T(1), T(0), T(0)}), turn({T(0), T(1), T(0)}), turn({T(0), T(0), T(1)}), {}};
  }
};

using Affine3f = Affine3<float>;
using Affine3d = Affine3<double>;

}  // namespace meristem
