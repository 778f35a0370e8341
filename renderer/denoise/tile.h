// How the image is cut up while it is denoised, and what around a pixel is looked at.
#pragma once

namespace meristem::denoise {

// In pixels. What a tile needs while it is worked on should stay in a core's own cache: 1.5 MB of weights.
constexpr int tile_width = 32, tile_height = 16;

// The window whose pixels contribute to the one in its middle, and the patches by which they are compared.
constexpr int window_radius = 9, patch_radius = 2;
constexpr int window_side = 2 * window_radius + 1, window_size = window_side * window_side;

struct Tile {
  int x0, y0;
};

}  // namespace meristem::denoise
