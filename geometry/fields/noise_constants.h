// What the kernels and the bounds of the noises both need to know. Specified in docs/expressions.md.
#pragma once

#include <array>
#include <cstdint>

namespace meristem {

// Gradients are whole numbers up to 2^31 a component; this makes the standard deviation of the noise 0.24. Beyond
// +-1, which one point in a million would reach, it is clamped.
constexpr float noise_scale = 0x1.4p-31f;
// No noise is steeper: the largest slope for any gradients is 5.781 (found by a search over the cell and directions:
// at its centre, along an axis).
constexpr double noise_slope = 5.8;
constexpr double noise_slope_4d = 8.2;  // 8.125, likewise

constexpr std::uint32_t vector_noise_seed_y = 0x68e31da4u;
constexpr std::uint32_t vector_noise_seed_z = 0xb5297a4du;

constexpr int max_octaves = 16;
constexpr float max_lacunarity = 64, max_gain = 64;  // larger ones are clamped

// The shift of octave k + 1: multiples of the golden ratio modulo 1, so that no point is the same in all octaves.
constexpr std::array<float, max_octaves> octave_shifts = [] {
  std::array<float, max_octaves> shifts{};
  double sum = 0;
  for (float& shift : shifts) {
    sum += 0.61803398875;
    if (sum >= 1) sum -= 1;
    shift = float(sum);
  }
  return shifts;
}();

}  // namespace meristem
