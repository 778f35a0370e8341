// Plane: one channel of an image with a border, in which the outermost pixels are repeated, so that windows around
// pixels need no cases at the edges of the image.
#pragma once

#include "geometry/base/parallel.h"

#include <cstddef>
#include <vector>

namespace meristem::denoise {

class Plane {
 public:
  static constexpr int border = 16;        // above, below, on the left
  static constexpr int right_border = 64;  // where tiles of full width may reach

  Plane() = default;
  Plane(int width, int height)
      : width_(width),
        height_(height),
        stride_(std::size_t(width) + border + right_border),
        values_(stride_ * (std::size_t(height) + 2 * border)) {}

  int width() const { return width_; }
  int height() const { return height_; }

  // Row y, from -border to height + border; x counts from -border to width + right_border.
  float* row(int y) { return &values_[std::size_t(y + border) * stride_ + border]; }
  const float* row(int y) const { return &values_[std::size_t(y + border) * stride_ + border]; }
  float at(int x, int y) const { return row(y)[x]; }

  // Fills the border from the pixels.
  void extend();

 private:
  int width_ = 0, height_ = 0;
  std::size_t stride_ = 0;
  std::vector<float> values_;
};

// Runs over the pixels in parallel.
template <class Body>
void for_pixels(const Plane& plane, Body body) {
  parallel_for(std::size_t(plane.height()), [&](std::size_t y) {
    for (int x = 0; x < plane.width(); ++x) body(x, int(y));
  });
}

// The mean over (2 radius + 1)^2 pixels around each; radius below border. Of an extended plane, and extended.
Plane box_mean(const Plane& plane, int radius);

}  // namespace meristem::denoise
