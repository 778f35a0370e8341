// The noises of the expression language over lanes. docs/expressions.md specifies them exactly: same text, same
// numbers.
//
// Gradient noise after Perlin 2002 ("Improving Noise": quintic fade). The gradient of a lattice point is not one of a
// few but any point of a cube, from an integer hash: no table, and no gradient comes twice.
// Only for the kernels_*.cpp files.
#pragma once

#include "geometry/fields/lanes.h"
#include "geometry/fields/noise_constants.h"

namespace meristem {
namespace {

constexpr std::uint32_t prime_x = 0xd1342543u, prime_y = 0xde82ef95u, prime_z = 0xa24baed5u;

struct Point {
  static constexpr int dimensions = 3;
  F x, y, z;
};

// Beyond 2^23 every float is a lattice point and the noise is 0; the clamp keeps all arithmetic finite.
MERISTEM_INLINE Point clamp_point(Point p) { return {limit(p.x, 0x1p24f), limit(p.y, 0x1p24f), limit(p.z, 0x1p24f)}; }

MERISTEM_INLINE F fade(F t) { return t * t * t * fused(t, fused(t, splat(6.0f), splat(-15.0f)), splat(10.0f)); }

// One axis of the cell around a point: hashed coordinates of its two planes, distances to them, weight of the second.
struct Axis {
  U hash0, hash1;
  F offset0, offset1;
  F weight;

  MERISTEM_INLINE F mix(F a, F b) const { return fused(weight, b - a, a); }
};
MERISTEM_INLINE Axis axis_of(F a, std::uint32_t prime) {
  I cell;
  const F t = a - floor(a, cell);
  const U h = U(cell) * prime;
  return {h, h + prime, t, t - 1.0f, fade(t)};
}

struct Cell {
  Axis x, y, z;
};
MERISTEM_INLINE Cell cell_of(Point p) { return {axis_of(p.x, prime_x), axis_of(p.y, prime_y), axis_of(p.z, prime_z)}; }

// The same on a lattice that comes again every max(trunc(period), 1) cells. All numbers are whole and below 2^25:
// exact.
MERISTEM_INLINE Axis periodic_axis_of(F a, F period, std::uint32_t prime) {
  period = clamp(trunc(period), splat(1.0f), splat(0x1p24f));
  const F cell = floor(a), t = a - cell;
  F first = fused(-floor(cell / period), period, cell);
  first = blend(first, first + period, I(first < 0.0f));  // where the quotient was rounded up
  first = blend(first, first - period, I(first >= period));
  const F second = blend(first + 1.0f, splat(0.0f), I(first + 1.0f >= period));
  return {U(truncate(first)) * prime, U(truncate(second)) * prime, t, t - 1.0f, fade(t)};
}
MERISTEM_INLINE Cell periodic_cell_of(Point p, Point period) {
  return {periodic_axis_of(p.x, period.x, prime_x), periodic_axis_of(p.y, period.y, prime_y),
          periodic_axis_of(p.z, period.z, prime_z)};
}

// The dot product of the offset with the gradient, whose components are three windows on the hash, each uniform
// in [-2^31, 2^31); a window's low bits are the next one's high bits, which matters to 1 part in 128.
MERISTEM_INLINE F corner(U hash, F x, F y, F z) {
  const I h = I(hash * hash);
  return fused(to_float(h), x, fused(to_float(h << 7), y, to_float(h << 14) * z));
}

// In units of 1 / noise_scale.
MERISTEM_INLINE F noise_at(const Cell& c, std::uint32_t seed) {
  const U x0 = c.x.hash0 ^ seed, x1 = c.x.hash1 ^ seed;
  auto row = [&](U y_hash, U z_hash, F y, F z) __attribute__((always_inline)) {
    return c.x.mix(corner(exclusive_or(y_hash, z_hash, x0), c.x.offset0, y, z),
                   corner(exclusive_or(y_hash, z_hash, x1), c.x.offset1, y, z));
  };
  auto plane = [&](U z_hash, F z) __attribute__((always_inline)) {
    return c.y.mix(row(c.y.hash0, z_hash, c.y.offset0, z), row(c.y.hash1, z_hash, c.y.offset1, z));
  };
  const F sum = c.z.mix(plane(c.z.hash0, c.z.offset0), plane(c.z.hash1, c.z.offset1));
  return limit(sum, 1 / noise_scale);
}
MERISTEM_INLINE F one_noise(const Cell& c) { return noise_at(c, 0); }
MERISTEM_INLINE Point vector_noise(const Cell& c) {
  return {noise_at(c, 0), noise_at(c, vector_noise_seed_y), noise_at(c, vector_noise_seed_z)};
}

// The lattice of the next octave: mirrored and turned by an angle that is no rational part of the circle, so that no
// two octaves share an axis, scaled by the lacunarity and shifted along the diagonal.
MERISTEM_INLINE Point next_octave(Point p, F lacunarity, float shift) {
  const F t = fused(p.y + p.z - p.x, lacunarity * 0.6666667f, splat(shift));
  return {fused(-lacunarity, p.y, t), fused(-lacunarity, p.z, t), fused(lacunarity, p.x, t)};
}

// lowbias32 (Wellons 2018, "Prospecting for Hash Functions"): every bit depends on every bit.
MERISTEM_INLINE U scramble(U h) {
  h = (h ^ (h >> 16)) * 0x7feb352du;
  h = (h ^ (h >> 15)) * 0x846ca68bu;
  return h ^ (h >> 16);
}
MERISTEM_INLINE F uniform(U h) { return to_float(I(h >> 8)) * 0x1p-24f; }  // [0, 1)

MERISTEM_INLINE U cell_hash(U x, U y, U z) { return scramble((x * prime_x) ^ (y * prime_y) ^ (z * prime_z)); }
MERISTEM_INLINE U cell_hash(Point p) {
  p = clamp_point(p);
  return cell_hash(U(truncate(floor(p.x))), U(truncate(floor(p.y))), U(truncate(floor(p.z))));
}
MERISTEM_INLINE Point color_of(U hash) {
  return {uniform(hash), uniform(scramble(hash + 1u)), uniform(scramble(hash + 2u))};
}

// The two feature points nearest to a point among the 27 cells around it.
struct Features {
  F distance1, distance2;  // squared until find_features returns
  Point position1, position2;
  U hash1;
};

MERISTEM_INLINE void visit_feature(Features& f, Point local, F jitter, U h, F i, F j, F k) {
  auto place = [&](F at, U bits) __attribute__((always_inline)) {
    return at + 0.5f + jitter * (to_float(I(bits & 1023u)) * (1.0f / 1023.0f) - 0.5f);
  };
  const Point q{place(i, h), place(j, h >> 10), place(k, h >> 20)};
  const F dx = q.x - local.x, dy = q.y - local.y, dz = q.z - local.z;
  const F d = dx * dx + dy * dy + dz * dz;
  const I first = I(d < f.distance1), second = I(d < f.distance2);
  auto insert = [&](F & nearest, F & next, F value) __attribute__((always_inline)) {
    next = blend(blend(next, value, second), nearest, first);
    nearest = blend(nearest, value, first);
  };
  insert(f.distance1, f.distance2, d);
  insert(f.position1.x, f.position2.x, q.x);
  insert(f.position1.y, f.position2.y, q.y);
  insert(f.position1.z, f.position2.z, q.z);
  f.hash1 = U(blend(F(f.hash1), F(h), first));
}

MERISTEM_INLINE F distance(Point a, Point b) {
  const F x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
  return sqrt(x * x + y * y + z * z);
}

// Positions come out relative to `cell`, the lower corner of the cell of p.
inline Features find_features(Point p, F jitter, Point& cell, Point& local) {
  p = clamp_point(p);
  jitter = clamp(jitter, splat(0.0f), splat(1.0f));
  cell = {floor(p.x), floor(p.y), floor(p.z)};
  local = {p.x - cell.x, p.y - cell.y, p.z - cell.z};
  const U x = U(truncate(cell.x)), y = U(truncate(cell.y)), z = U(truncate(cell.z));
  Features f{splat(64.0f), splat(64.0f), {}, {}, {}};
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i)
        visit_feature(f, local, jitter, cell_hash(x + std::uint32_t(i), y + std::uint32_t(j), z + std::uint32_t(k)),
                      splat(float(i)), splat(float(j)), splat(float(k)));
  f.distance1 = sqrt(f.distance1);
  f.distance2 = sqrt(f.distance2);
  return f;
}

MERISTEM_INLINE F smooth_curve(F t) { return t * t * (3.0f - 2.0f * t); }

// The types of voronoi(), 1 to 5.
MERISTEM_INLINE F voronoi_value(const Features& f, Point local, int type) {
  switch (type) {
    case 1: return f.distance1;
    case 2: return f.distance2;
    case 3: return f.distance2 - f.distance1;
    case 5: return (f.distance1 + f.distance2) * 0.5f;
    default: break;
  }
  // 4: the width of the border is in proportion to the distance of the two points.
  const F sum = distance(f.position1, local) + distance(f.position2, local);
  const F border = distance(f.position1, f.position2) * 0.1f / max(sum, splat(1e-6f));
  return smooth_curve(clamp((f.distance2 - f.distance1) / max(border, splat(1e-6f)), splat(0.0f), splat(1.0f)));
}

}  // namespace
}  // namespace meristem
