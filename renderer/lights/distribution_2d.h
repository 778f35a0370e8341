// Distribution2D: samples the unit square with a density that is constant on each cell of a grid. Immutable; any
// thread; a sample costs the same for any size: tables say where to look.
#pragma once

#include "geometry/base/vec.h"

#include <cstdint>
#include <vector>

namespace meristem {

class Distribution2D {
 public:
  Distribution2D() = default;
  // `weights` row by row (x fastest), not negative. If all are zero, every cell weighs the same.
  Distribution2D(std::vector<float> weights, int width, int height);

  bool empty() const { return density_.empty(); }
  Vec2f sample(Vec2f random) const;
  // The density at a point; its integral over the unit square is 1.
  float pdf(Vec2f p) const;

 private:
  int width_ = 0, height_ = 0;
  std::vector<float> density_;
  std::vector<double> row_ends_;   // cumulative weight of whole rows, ends at 1
  std::vector<double> cell_ends_;  // cumulative inside each row, ends at 1
  // Of equal parts of the random number, a quarter as many as there are rows, or cells in a row: where each begins.
  std::vector<std::uint32_t> first_rows_, first_cells_;
};

}  // namespace meristem
