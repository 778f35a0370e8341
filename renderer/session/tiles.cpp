#include "renderer/session/tiles.h"

#include "geometry/base/check.h"

#include <utility>

namespace meristem {

namespace {

// The cell at distance d along the Hilbert curve over a grid of side x side cells, side a power of two (Hilbert 1891):
// from the finest quadrant up, each level turns what it holds as its quadrant stands.
std::pair<int, int> hilbert_cell(int side, std::uint64_t d) {
  int x = 0, y = 0;
  for (int size = 1; size < side; size *= 2, d /= 4) {
    const bool right = (d & 2) != 0, upper = right != ((d & 1) != 0);
    if (!upper) {
      if (right) x = size - 1 - x, y = size - 1 - y;
      std::swap(x, y);
    }
    x += right ? size : 0;
    y += upper ? size : 0;
  }
  return {x, y};
}

}  // namespace

std::vector<PixelWindow> tiles_along_hilbert_curve(const PixelWindow& window, int side) {
  CHECK(side > 0, "tiles of {} pixels", side);
  const int columns = (window.width() + side - 1) / side, rows = (window.height() + side - 1) / side;
  int grid = 1;
  while (grid < columns || grid < rows) grid *= 2;
  std::vector<PixelWindow> tiles;
  for (std::uint64_t d = 0; d < std::uint64_t(grid) * std::uint64_t(grid); ++d) {
    const auto [column, row] = hilbert_cell(grid, d);
    if (column >= columns || row >= rows) continue;
    const int x = window.x0 + column * side, y = window.y0 + row * side;
    tiles.push_back(PixelWindow{x, y, x + side, y + side}.intersected(window));
  }
  return tiles;
}

}  // namespace meristem
