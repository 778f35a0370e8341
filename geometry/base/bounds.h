// Bounds3: an axis-aligned box. Empty when default-constructed (lower > upper); extend() makes it grow.
#pragma once

#include "geometry/base/vec.h"

#include <limits>

namespace meristem {

template <class T>
struct Bounds3 {
  Vec3<T> lower{Vec3<T>(std::numeric_limits<T>::infinity())};
  Vec3<T> upper{Vec3<T>(-std::numeric_limits<T>::infinity())};

  bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
  void extend(Vec3<T> p) {
    lower = min(lower, p);
    upper = max(upper, p);
  }
  void extend(const Bounds3& b) {
    lower = min(lower, b.lower);
    upper = max(upper, b.upper);
  }
  // The box grown by d (not negative) on every side.
  Bounds3 inflated(Vec3<T> d) const { return {lower - d, upper + d}; }
  bool contains(Vec3<T> p) const {
    return p.x >= lower.x && p.y >= lower.y && p.z >= lower.z && p.x <= upper.x && p.y <= upper.y && p.z <= upper.z;
  }
  bool contains(const Bounds3& b) const { return b.empty() || (contains(b.lower) && contains(b.upper)); }
  Vec3<T> center() const { return (lower + upper) * T(0.5); }
  Vec3<T> size() const { return upper - lower; }
  T diagonal() const { return empty() ? T(0) : length(size()); }
  T surface_area() const {
    const Vec3<T> s = size();
    return empty() ? T(0) : 2 * (s.x * s.y + s.y * s.z + s.z * s.x);
  }
};

using Bounds3f = Bounds3<float>;
using Bounds3d = Bounds3<double>;

// The smallest float box that holds a double box: rounded outwards.
inline Bounds3f round_outwards(const Bounds3d& b) {
  auto down = [](double x) {
    const float f = float(x);
    return double(f) <= x ? f : std::nextafterf(f, -INFINITY);
  };
  auto up = [](double x) {
    const float f = float(x);
    return double(f) >= x ? f : std::nextafterf(f, INFINITY);
  };
  return {{down(b.lower.x), down(b.lower.y), down(b.lower.z)}, {up(b.upper.x), up(b.upper.y), up(b.upper.z)}};
}

}  // namespace meristem
