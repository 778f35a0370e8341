// FilterSampler: importance sampling of the scene's reconstruction filter (Ernst, Stamminger, Greiner 2006, "Filter
// Importance Sampling"). A sample belongs to one pixel alone, and lies where the filter sends it; so pixels are
// independent, and tiles and threads cannot change a sum.
//
// The filter is tabulated once, in one dimension, as a step function of 1024 cells; this function is sampled without
// further error. Where the filter is negative a sample has the sign -1. Read-only after construction: any thread.
#pragma once

#include "renderer/scene/interfaces.h"

#include <cstdint>
#include <vector>

namespace meristem {

struct FilterSample {
  Vec2f offset;      // from the centre of the pixel, in pixels
  float weight = 1;  // +1 or -1
};

class FilterSampler {
 public:
  // A filter without any weight becomes a box of its radius.
  explicit FilterSampler(const Filter& filter);

  FilterSample sample(Vec2f random) const;
  // The mean of the samples' weights: 1 for a filter without negative lobes.
  float mean_weight() const { return mean_weight_; }

 private:
  struct Sample1D {
    float offset, sign;
  };
  Sample1D sample_1d(float random) const;

  // A cell of the step function: the random number at which it begins, and the sign of the filter.
  struct Cell {
    float begin, sign;
  };

  float radius_;
  float mean_weight_ = 1;
  std::vector<Cell> cells_;  // and one behind the last, which begins at 1
  // Four times as many equal steps of the random number as there are cells: in which cell each begins, so that a
  // look-up goes on from there instead of bisecting, mostly by no step at all.
  std::vector<std::uint16_t> first_cells_;
};

}  // namespace meristem
