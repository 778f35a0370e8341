#include "renderer/denoise/plane.h"

#include "geometry/base/check.h"
#include "geometry/base/parallel.h"

#include <algorithm>

namespace meristem::denoise {

void Plane::extend() {
  for (int y = 0; y < height_; ++y) {
    float* const line = row(y);
    std::fill(line - border, line, line[0]);
    std::fill(line + width_, line + width_ + right_border, line[width_ - 1]);
  }
  for (int y = 1; y <= border; ++y) {
    std::copy_n(row(0) - border, stride_, row(-y) - border);
    std::copy_n(row(height_ - 1) - border, stride_, row(height_ - 1 + y) - border);
  }
}

Plane box_mean(const Plane& plane, int radius) {
  CHECK(radius < Plane::border, "a radius of {}", radius);
  Plane result(plane.width(), plane.height());
  const float scale = 1 / float((2 * radius + 1) * (2 * radius + 1));
  parallel_for(std::size_t(plane.height()), [&](std::size_t y) {
    std::vector<float> columns(std::size_t(plane.width() + 2 * radius), 0.0f);
    for (int dy = -radius; dy <= radius; ++dy) {
      const float* const from = plane.row(int(y) + dy) - radius;
      for (std::size_t x = 0; x < columns.size(); ++x) columns[x] += from[x];
    }
    float* const to = result.row(int(y));
    for (int x = 0; x < plane.width(); ++x) {
      float sum = 0;
      for (int dx = 0; dx <= 2 * radius; ++dx) sum += columns[std::size_t(x + dx)];
      to[x] = sum * scale;
    }
  });
  result.extend();
  return result;
}

}  // namespace meristem::denoise
