// The kernels of child_kernels.h, compiled once by each of the child_kernels_*.cpp files. They call no inline function
// of other headers that might be compiled here and then serve the whole program.
#pragma once

#include "procedural/plants/child_kernels.h"
#include "procedural/plants/stem.h"

// After the others: from here on code is for this instruction set
#include "geometry/fields/math_lanes.h"

namespace meristem {
namespace {

constexpr std::size_t doubles = width / 2;
static_assert(doubles <= ChildRows::group);

struct Vec {
  D x, y, z;
};
MERISTEM_INLINE Vec splat(const Vec3d& v) { return {splat(v.x), splat(v.y), splat(v.z)}; }
MERISTEM_INLINE Vec operator+(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
MERISTEM_INLINE Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
MERISTEM_INLINE Vec operator*(const Vec& a, D s) { return {a.x * s, a.y * s, a.z * s}; }
MERISTEM_INLINE Vec operator/(const Vec& a, D s) { return {a.x / s, a.y / s, a.z / s}; }
MERISTEM_INLINE D dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
MERISTEM_INLINE Vec cross(const Vec& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
MERISTEM_INLINE Vec blend(const Vec& a, const Vec& b, L mask) {
  return {blend(a.x, b.x, mask), blend(a.y, b.y, mask), blend(a.z, b.z, mask)};
}
MERISTEM_INLINE D length(const Vec& v) { return sqrt(dot(v, v)); }

MERISTEM_INLINE Vec load_vec(const ChildRows::View& rows, int row, std::size_t i) {
  return {load(rows[row] + i), load(rows[row + 1] + i), load(rows[row + 2] + i)};
}
MERISTEM_INLINE void store_vec(const ChildRows::View& rows, int row, std::size_t i, const Vec& v) {
  store(rows[row] + i, v.x);
  store(rows[row + 1] + i, v.y);
  store(rows[row + 2] + i, v.z);
}

struct Turn {
  D cosine, sine;
};
MERISTEM_INLINE Turn turn_by(D angle) {
  L quarter;
  const D r = reduce_angle(angle, quarter);
  const D s = sin_series(r), c = cos_series(r);
  const L odd = quarter << 63;
  return {D(L(blend(c, s, odd)) ^ (((quarter + 1) & 2) << 62)), D(L(blend(s, c, odd)) ^ ((quarter & 2) << 62))};
}
// Turns a towards b, and b away from a.
MERISTEM_INLINE void turn(Vec& a, Vec& b, const Turn& by) {
  const Vec before = a;
  a = a * by.cosine + b * by.sine;
  b = b * by.cosine - before * by.sine;
}
MERISTEM_INLINE D arc_cosine(D a) {
  a = limit(a, 1);
  return arc_tangent(sqrt((1.0 - a) * (1.0 + a)), a);
}

void put_on_axis(const StemNode& a, const StemNode& b, ChildRows::View rows, std::size_t begin, std::size_t end) {
  const Vec from = splat(a.frame.origin), to = splat(b.frame.origin), tangent_a = splat(a.tangent),
            tangent_b = splat(b.tangent), x = splat(a.frame.x), y = splat(a.frame.y), z = splat(a.frame.z),
            chord = to - from;
  const D size = length(chord), h = size / splat(3.0);
  const Vec straight = blend(Vec{}, chord / size, L(size > 0.0));
  for (std::size_t i = begin; i < end; i += doubles) {
    const D t = load(rows[ChildRows::part] + i), s = 1.0 - t;
    // As Stem::position and Stem::tangent
    store_vec(rows, ChildRows::origin, i,
              from * (s * s * (1.0 + 2.0 * t)) + to * (t * t * (3.0 - 2.0 * t)) + tangent_a * (3.0 * h * s * s * t) -
                  tangent_b * (3.0 * h * s * t * t));
    const Vec d =
        chord * (6.0 * s * t) + (tangent_a * (s * s - 2.0 * s * t) + tangent_b * (t * t - 2.0 * s * t)) * size;
    const D l = length(d);
    const Vec tangent = blend(straight, d / l, L(l > 0.0));
    // As lead_to
    const Vec axis = cross(z, tangent);
    const D cosine = dot(z, tangent);
    const L turns = L(1.0 + cosine >= 1e-9);
    const auto turned = [&](const Vec& v) __attribute__((always_inline)) {
      return v * cosine + cross(axis, v) + axis * (dot(axis, v) / (1.0 + cosine));
    };
    store_vec(rows, ChildRows::x_axis, i, blend(x, turned(x), turns));
    store_vec(rows, ChildRows::y_axis, i, blend(y, turned(y), turns));
    store_vec(rows, ChildRows::z_axis, i, blend(z, tangent, turns));
  }
}

void turn_away(ChildRows::View rows, std::size_t count) {
  for (std::size_t i = 0; i < count; i += doubles) {
    Vec x = load_vec(rows, ChildRows::x_axis, i), y = load_vec(rows, ChildRows::y_axis, i),
        z = load_vec(rows, ChildRows::z_axis, i);
    turn(x, y, turn_by(load(rows[ChildRows::around] + i)));
    turn(y, z, turn_by(load(rows[ChildRows::away] + i)));
    store_vec(rows, ChildRows::x_axis, i, x);
    store_vec(rows, ChildRows::y_axis, i, y);
    store_vec(rows, ChildRows::z_axis, i, z);
  }
}

void turn_to_light(ChildRows::View rows, std::size_t count, double bend) {
  for (std::size_t i = 0; i < count; i += doubles) {
    const Vec o = load_vec(rows, ChildRows::origin, i);
    Vec x = load_vec(rows, ChildRows::x_axis, i), y = load_vec(rows, ChildRows::y_axis, i),
        z = load_vec(rows, ChildRows::z_axis, i);
    const Turn about_up = turn_by(bend * arc_tangent(y.z * o.x - y.x * o.z, y.x * o.x + y.z * o.z));
    for (Vec* v : {&x, &y, &z}) {
      const D vx = v->x;
      v->x = vx * about_up.cosine + v->z * about_up.sine;
      v->z = v->z * about_up.cosine - vx * about_up.sine;
    }
    const D tilt = bend * arc_cosine(y.y);
    turn(y, z, turn_by(blend(tilt, -tilt, L(z.y < 0.0))));
    store_vec(rows, ChildRows::x_axis, i, x);
    store_vec(rows, ChildRows::y_axis, i, y);
    store_vec(rows, ChildRows::z_axis, i, z);
  }
}

void put_vertices(ChildRows::View rows, std::size_t first, const LeafVertices& leaf, double* out) {
  for (std::size_t i = 0; i < ChildRows::group; i += doubles) {
    const Vec x = load_vec(rows, ChildRows::x_axis, first + i), y = load_vec(rows, ChildRows::y_axis, first + i),
              z = load_vec(rows, ChildRows::z_axis, first + i);
    const Vec origin = load_vec(rows, ChildRows::origin, first + i) + z * splat(leaf.forward);
    for (std::size_t v = 0; v < leaf.count; ++v) {
      const Vec vertex = splat(leaf.vertices[v]);
      const Vec at = origin + (z * vertex.y + y * vertex.z - x * vertex.x);
      double* const to = out + 3 * v * ChildRows::group + i;
      store(to, (at.x + leaf.magic) - leaf.magic);
      store(to + ChildRows::group, (at.y + leaf.magic) - leaf.magic);
      store(to + 2 * ChildRows::group, (at.z + leaf.magic) - leaf.magic);
    }
  }
}

constexpr ChildKernels table{put_on_axis, turn_away, turn_to_light, put_vertices};

}  // namespace
}  // namespace meristem
