// Pixels that are unlike all around them, and would lend their light to whole windows: fireflies, which are noise, and
// small lights, which are not. Before anything is fitted.
#pragma once

#include "renderer/denoise/regression.h"
#include "renderer/scene/interfaces.h"

#include <array>
#include <vector>

namespace meristem::denoise {

struct LightPixel {
  int x, y;
  Vec3f color;
};

// Takes out what is no noise and yet unlike all around: the sun where it is no larger than a few pixels, or a lamp far
// away. What its samples differ by is more than any surroundings do, so it would lend light to all pixels in whose
// windows it lies. Such a pixel is brighter than the middle one around, and than the picture, a hundred times over, and
// shows no surface, or both halves say so of it or its neighbours; it gets the colour of that middle one, and is put
// back at the end.
std::vector<LightPixel> take_out_lights(const Features& features, std::array<Color, 2>& halves, Plane& variance);

// Takes out what a single path has brought and none around it: a pixel of one half that is brighter than its
// surroundings in both halves, and than the other half, comes down to the larger of the two; and the variance of its
// samples with it, which would otherwise tell of light that is no longer there.
void dim_fireflies(std::array<Color, 2>& halves, Plane& variance);

}  // namespace meristem::denoise
