// Gradient noise in four dimensions: that of noise_lanes.h with a time, on a lattice of points (i, j, k, l). A gradient
// has a fourth component from the same hash, so that at time 0, where the fourth distance is 0, all bits are those of
// the noise in space. Only for the kernels_*.cpp files.
#pragma once

#include "geometry/fields/noise_lanes.h"

namespace meristem {
namespace {

constexpr std::uint32_t prime_t = 0x9fb21c65u, time_window = 0x9e3779b1u;

struct Point4 {
  static constexpr int dimensions = 4;
  Point space;
  F time;
};
MERISTEM_INLINE Point4 clamp_point(Point4 p) { return {clamp_point(p.space), limit(p.time, 0x1p24f)}; }

struct Cell4 {
  Cell space;
  Axis time;
};
MERISTEM_INLINE Cell4 cell_of(Point4 p) { return {cell_of(p.space), axis_of(p.time, prime_t)}; }

// As corner() in space; the fourth window mixes all bits of the hash, of which shifting leaves too few.
MERISTEM_INLINE F corner(U hash, F x, F y, F z, F t) {
  const U square = hash * hash;
  const I h = I(square);
  const F along_time = to_float(I(square * time_window)) * t;
  return fused(to_float(h), x, fused(to_float(h << 7), y, fused(to_float(h << 14), z, along_time)));
}

// The noise of one of the cell's two spaces, `t` away.
MERISTEM_INLINE F space_at(const Cell& c, U time_hash, F t) {
  const U x0 = c.x.hash0 ^ time_hash, x1 = c.x.hash1 ^ time_hash;
  auto row = [&](U y_hash, U z_hash, F y, F z) __attribute__((always_inline)) {
    return c.x.mix(corner(exclusive_or(y_hash, z_hash, x0), c.x.offset0, y, z, t),
                   corner(exclusive_or(y_hash, z_hash, x1), c.x.offset1, y, z, t));
  };
  auto plane = [&](U z_hash, F z) __attribute__((always_inline)) {
    return c.y.mix(row(c.y.hash0, z_hash, c.y.offset0, z), row(c.y.hash1, z_hash, c.y.offset1, z));
  };
  return c.z.mix(plane(c.z.hash0, c.z.offset0), plane(c.z.hash1, c.z.offset1));
}
// In units of 1 / noise_scale.
MERISTEM_INLINE F noise_at(const Cell4& c, std::uint32_t seed) {
  const F sum = c.time.mix(space_at(c.space, c.time.hash0 ^ seed, c.time.offset0),
                           space_at(c.space, c.time.hash1 ^ seed, c.time.offset1));
  return limit(sum, 1 / noise_scale);
}
MERISTEM_INLINE F one_noise(const Cell4& c) { return noise_at(c, 0); }
MERISTEM_INLINE Point vector_noise(const Cell4& c) {
  return {noise_at(c, 0), noise_at(c, vector_noise_seed_y), noise_at(c, vector_noise_seed_z)};
}

// Space as without a time; times keep their axis, so that what changes slowly does so in all octaves.
MERISTEM_INLINE Point4 next_octave(Point4 p, F lacunarity, float shift) {
  return {next_octave(p.space, lacunarity, shift), fused(lacunarity, p.time, splat(shift))};
}

}  // namespace
}  // namespace meristem
