// How two images differ. Values that are not finite are counted first and left out of the measures: a comparer that
// takes NaN for equal has let broken images pass.
#pragma once

#include "renderer/image/image.h"

#include <cstdint>

namespace meristem {

struct ImageDifference {
  std::uint64_t nonfinite = 0;  // values that are NaN or infinite in either image
  std::uint64_t differing = 0;  // pixels with a channel that differs in any way, or is not finite in either
  double max = 0;               // largest |a - b| of finite values
  double rms = 0;               // root of the mean of (a - b)^2 over finite values

  bool identical() const { return differing == 0; }
};

// Throws std::invalid_argument if the sizes or channels differ.
ImageDifference image_difference(const Image& a, const Image& b);

}  // namespace meristem
