#include "renderer/report/image_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace meristem {

ImageDifference image_difference(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height || a.channels != b.channels)
    throw std::invalid_argument(fmt::format("images of {} x {} x {} and {} x {} x {} cannot be compared", a.width,
                                            a.height, a.channels, b.width, b.height, b.channels));
  ImageDifference result;
  double squares = 0;
  std::uint64_t finite = 0;
  const std::size_t channels = std::size_t(a.channels);
  for (std::size_t pixel = 0; pixel < a.pixels.size(); pixel += channels) {
    bool differs = false;
    for (std::size_t i = pixel; i < pixel + channels; ++i) {
      const double difference = std::abs(double(a.pixels[i]) - double(b.pixels[i]));
      differs |= !(difference == 0);  // NaN differs
      if (!std::isfinite(a.pixels[i]) || !std::isfinite(b.pixels[i])) {
        ++result.nonfinite;
        differs = true;
        continue;
      }
      ++finite;
      squares += difference * difference;
      result.max = std::max(result.max, difference);
    }
    result.differing += differs;
  }
  if (finite > 0) result.rms = std::sqrt(squares / double(finite));
  return result;
}

}  // namespace meristem
