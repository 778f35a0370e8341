// LDR-FLIP: how different two images look when one is flipped to the other, pixel by pixel: 0 the same, 1 as different
// as colours can be. Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem, Fairchild 2020, "FLIP: A Difference
// Evaluator for Alternating Images", sections 4.1 to 4.4, with the constants given there.
//
// Cost: about 2 microseconds a pixel at 67 pixels a degree.
#pragma once

#include "renderer/image/image.h"

namespace meristem {

struct FlipOptions {
  // Of the observer's view: 67 is a 4K display 0.7 m wide seen from 0.7 m, the paper's default.
  float pixels_per_degree = 67;
};

// Of two images of 3 or 4 channels with display values (sRGB); values outside [0, 1] are clamped, alpha is ignored,
// what is not a number counts as 0. The result has one channel. Throws std::invalid_argument if the sizes differ.
Image flip(const Image& reference, const Image& test, const FlipOptions& options = {});

// Of all its values.
double mean_value(const Image& image);

}  // namespace meristem
