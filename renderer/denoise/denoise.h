// Denoises a picture of few samples a pixel, guided by what else is known of its pixels: half buffers (two independent
// pictures of half the samples each), the variance of the samples, albedo and normal. Textures, leaves and edges are
// kept, because colour is fitted to albedo and normal (regression.h) among pixels whose surroundings are alike
// (weights.h).
//
// Deterministic for any number of threads; uses all of TBB's. About 10 s of processor time for 1280 x 720 pixels. Input
// without noise comes out as it is, to 1e-3.
#pragma once

#include "renderer/film/film.h"
#include "renderer/image/image.h"

#include <array>
#include <vector>

namespace meristem::denoise {

struct Input {
  std::array<Image, 2> halves;  // 3 or 4 channels, of which the first three are denoised
  Image variance;               // of the luminance of the mean, as the samples tell: 1 channel
  Image albedo, normal;         // 3 channels
};

// RGB.
Image denoised(const Input& input);

// What a film must hold.
const std::vector<Aov>& wanted_aovs();
bool can_denoise(const Film& film);

// The film's picture, denoised: RGBA; alpha is as it is.
Image denoised(const Film& film);

}  // namespace meristem::denoise
