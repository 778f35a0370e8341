// First-order regression of colour on features in the window around a pixel: where light is even, colour follows
// albedo and normal linearly, and so do pixels in which leaf and sky mix. What the fit gives for the pixel in the
// middle is its colour without noise. Moon, Carr, Yoon 2014 and Bitterli et al. 2016, "Nonlinearly Weighted First-order
// Regression for Denoising Monte Carlo Renderings" (NFOR). Pure functions.
#pragma once

#include "renderer/denoise/plane.h"
#include "renderer/denoise/tile.h"

#include <array>

namespace meristem::denoise {

constexpr int feature_count = 6;  // albedo, normal

using Color = std::array<Plane, 3>;
using Features = std::array<Plane, feature_count>;

// Fits the halves of a tile at once. `weights` of each half are those of the other (weights.h), so that what a half
// happens to be is not what decides about it. `stiffness`: relative variance of pixels, by which slopes are held back
// where they would follow the noise.
void fit_tile(const std::array<Color, 2>& halves, const Features& features, const Plane& stiffness, const Tile& tile,
              const std::array<const float*, 2>& weights, std::array<Color, 2>& out);

}  // namespace meristem::denoise
