// The order in which a picture is visited: square tiles along a Hilbert curve, so that threads work near each other and
// near what they expanded just before. A pure function of the window.
#pragma once

#include "renderer/film/film.h"

#include <vector>

namespace meristem {

// Tiles of `side` pixels that cover the window exactly, those at its right and lower border cut.
std::vector<PixelWindow> tiles_along_hilbert_curve(const PixelWindow& window, int side);

}  // namespace meristem
