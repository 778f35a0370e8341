// How much alike the surroundings of two pixels are, as weights of non-local means: Buades, Coll, Morel 2005, with the
// distance of Rousselle, Knaus, Zwicker 2012 ("Adaptive Rendering with Non-Local Means Filtering", section 4), which
// knows the variance of each pixel: pixels that differ by no more than their noise are alike. Pure functions.
#pragma once

#include "renderer/denoise/plane.h"
#include "renderer/denoise/tile.h"

#include <array>

namespace meristem::denoise {

// A noisy image by which pixels are compared. Planes are extended.
struct Guide {
  std::array<Plane, 3> color, variance;
};

// The weights of all pixels of the windows around all pixels of a tile: out[offset][y][x], offsets row by row. 0 for
// pixels outside of the image. `strictness`: 1 takes for noise what noise can be, less makes finer distinctions.
void find_weights(const Guide& guide, const Tile& tile, float strictness, float* out);

}  // namespace meristem::denoise
