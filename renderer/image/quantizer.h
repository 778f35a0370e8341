// Quantizer: display values as the steps of an integer format. The one place where 8-bit pictures are made.
//
// Rounded to the nearest step, a dark smooth wall or a sky falls into bands. Dithered, a value becomes one of the steps
// around it, by chance, so that the mean of many pixels is the value. The chance is triangular, from -1 to 1 steps:
// then the noise is as strong everywhere. It is a hash of pixel and channel, made such that it adds up to nothing over
// every 2 x 2 pixels: noise that fine is hardly seen. Within half a step of black and white it is uniform in the step,
// so that these stay as they are. A value; any thread; some 5 ns a call.
#pragma once

#include "renderer/image/image.h"

#include <cstdint>

namespace meristem {

class Quantizer {
 public:
  // To 2^bits steps: dithered if there are 256 and the options say so, else to the nearest.
  Quantizer(int bits, const WriteOptions& options)
      : last_((1u << bits) - 1), dithers_(bits == 8 && options.dither), x0_(options.x0), y0_(options.y0) {}

  std::uint32_t last() const { return last_; }
  // From 0 to last(), of a value that is clamped to [0, 1]; what is no number is 0.
  std::uint32_t step(float value, int x, int y, int channel) const;

 private:
  std::uint32_t last_;
  bool dithers_;
  int x0_, y0_;
};

}  // namespace meristem
