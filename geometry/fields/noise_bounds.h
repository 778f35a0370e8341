// Bounds of the gradient noises over boxes of places: their value at the centre and their greatest slope, octave by
// octave. Pure; any thread. About as dear as sixteen values of the noise for each octave.
#pragma once

#include "geometry/fields/operations.h"
#include "geometry/fields/range.h"

#include <array>

namespace meristem {

// A noise, and what it may be asked for.
struct NoisePlaces {
  Op op;
  int octaves = 1;                        // of those that have_octaves()
  std::array<bounds::Range, 4> place{};   // the last: time, of those in four dimensions
  std::array<bounds::Range, 3> period{};  // of PeriodicNoise
  bounds::Range lacunarity{}, gain{};
};

bool has_octaves(Op op);
int noise_dimensions(Op op);  // 3 or 4

// The first range bounds a noise of one component.
bounds::Box noise_bounds(const NoisePlaces& places);

}  // namespace meristem
