// PixelWindow: a rectangle of pixels of the full frame, [x0, x1) x [y0, y1).
#pragma once

#include <algorithm>

namespace meristem {

struct PixelWindow {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool empty() const { return x1 <= x0 || y1 <= y0; }
  PixelWindow intersected(const PixelWindow& w) const {
    return {std::max(x0, w.x0), std::max(y0, w.y0), std::min(x1, w.x1), std::min(y1, w.y1)};
  }
  bool operator==(const PixelWindow&) const = default;
};

}  // namespace meristem
