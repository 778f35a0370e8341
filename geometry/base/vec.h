// Vec2, Vec3: plain arrays of two or three numbers with the usual arithmetic. Aggregates, trivially copyable.
// Coordinates are right-handed with y up; lengths are metres in model and world space.
// Files that use these where borders must agree are built with -ffp-contract=off (the whole project is).
#pragma once

#include <algorithm>
#include <cmath>

namespace meristem {

constexpr double pi = 3.14159265358979323846;

template <class T>
struct Vec2 {
  T x{}, y{};

  constexpr Vec2 operator+(Vec2 b) const { return {x + b.x, y + b.y}; }
  constexpr Vec2 operator-(Vec2 b) const { return {x - b.x, y - b.y}; }
  constexpr Vec2 operator*(T s) const { return {x * s, y * s}; }
  constexpr bool operator==(const Vec2&) const = default;
};

template <class T>
struct Vec3 {
  T x{}, y{}, z{};

  constexpr Vec3() = default;
  constexpr Vec3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
  constexpr explicit Vec3(T s) : x(s), y(s), z(s) {}
  template <class U>
  constexpr explicit Vec3(const Vec3<U>& v) : x(T(v.x)), y(T(v.y)), z(T(v.z)) {}

  constexpr T& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
  constexpr T operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }

  constexpr Vec3 operator+(Vec3 b) const { return {x + b.x, y + b.y, z + b.z}; }
  constexpr Vec3 operator-(Vec3 b) const { return {x - b.x, y - b.y, z - b.z}; }
  constexpr Vec3 operator-() const { return {-x, -y, -z}; }
  constexpr Vec3 operator*(T s) const { return {x * s, y * s, z * s}; }
  constexpr Vec3 operator*(Vec3 b) const { return {x * b.x, y * b.y, z * b.z}; }
  constexpr Vec3 operator/(T s) const { return {x / s, y / s, z / s}; }
  constexpr Vec3 operator/(Vec3 b) const { return {x / b.x, y / b.y, z / b.z}; }
  constexpr Vec3& operator+=(Vec3 b) { return *this = *this + b; }
  constexpr Vec3& operator-=(Vec3 b) { return *this = *this - b; }
  constexpr Vec3& operator*=(T s) { return *this = *this * s; }
  constexpr Vec3& operator*=(Vec3 b) { return *this = *this * b; }
  constexpr Vec3& operator/=(T s) { return *this = *this / s; }
  constexpr bool operator==(const Vec3&) const = default;
};

template <class T>
constexpr Vec3<T> operator*(T s, Vec3<T> v) {
  return v * s;
}

using Vec2f = Vec2<float>;
using Vec2d = Vec2<double>;
using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

template <class T>
constexpr T dot(Vec3<T> a, Vec3<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
constexpr Vec3<T> cross(Vec3<T> a, Vec3<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
constexpr T length_squared(Vec3<T> v) {
  return dot(v, v);
}
template <class T>
T length(Vec3<T> v) {
  return std::sqrt(dot(v, v));
}
// The unit vector along v; the zero vector when v is zero.
template <class T>
Vec3<T> normalize(Vec3<T> v) {
  const T l = length(v);
  return l > T(0) ? v / l : Vec3<T>{};
}
template <class T>
constexpr Vec3<T> min(Vec3<T> a, Vec3<T> b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
template <class T>
constexpr Vec3<T> max(Vec3<T> a, Vec3<T> b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
template <class T>
constexpr Vec3<T> abs(Vec3<T> v) {
  return {std::abs(v.x), std::abs(v.y), std::abs(v.z)};
}
template <class T>
constexpr T max_component(Vec3<T> v) {
  return std::max(v.x, std::max(v.y, v.z));
}
template <class T>
constexpr Vec3<T> lerp(Vec3<T> a, Vec3<T> b, T t) {
  return a * (T(1) - t) + b * t;
}
template <class T>
bool is_finite(Vec3<T> v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Two unit vectors that make a right-handed orthonormal frame (s, t, n) with the unit vector n.
// Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
template <class T>
void orthonormal_basis(Vec3<T> n, Vec3<T>& s, Vec3<T>& t) {
  const T sign = std::copysign(T(1), n.z);
  const T a = T(-1) / (sign + n.z);
  const T b = n.x * n.y * a;
  s = {T(1) + sign * n.x * n.x * a, sign * b, -sign * n.x};
  t = {b, sign + n.y * n.y * a, -n.y};
}

}  // namespace meristem
