// Adaptive sampling: which pixels need no more samples.
//
// The noise of a pixel is the standard error of its luminance over the square root of the luminance, as the eye and the
// display transform see it (Dammertz, Hanika, Keller, Lensch 2010, "A Hierarchical Automatic Stopping Condition for
// Monte Carlo Global Illumination"; Cycles measures the same way). 0.01 looks clean, 0.05 grainy.
//
// A rule that stops a pixel by its own samples is biased: it keeps the pixels that look settled because they have
// missed what is bright and rare, and the image gets too dark. So the samples that decide are not those decided upon. A
// pixel's variance is taken from its neighbours, 7 x 7 pixels without itself, whose random numbers are their own; and
// it is asked at few numbers of samples that are fixed beforehand: 16, 32, 64, ... At the first of these the choice
// does not depend on the pixel's own samples at all. At later ones it does so only through how many samples its
// neighbours were given, an effect that the tests do not find. Sobol points have less error than the variance of their
// samples says, so pixels end better than asked for.
#pragma once

#include "renderer/film/film_file.h"

#include <bit>

namespace meristem::noise {

constexpr std::uint32_t first_decision = 16;  // samples
constexpr int radius = 3;                     // of the neighbourhood, pixels

constexpr bool is_decision(std::uint32_t samples) { return samples >= first_decision && std::has_single_bit(samples); }

// Marks the pixels that are finished now that those not yet finished have `samples` samples. `limit` is the noise
// that is still allowed. A film of a single pixel has no neighbours and never finishes. Deterministic; 0.1 us a pixel.
void choose_finished(const Film& film, std::uint32_t samples, double limit, AdaptiveState& state);

}  // namespace meristem::noise
