#include "renderer/film/filter_sampler.h"

#include "geometry/base/check.h"

#include <algorithm>

namespace meristem {

namespace {

constexpr int cell_count = 1024;  // even, so that no cell straddles the centre
constexpr int step_count = 4 * cell_count;

}  // namespace

FilterSampler::FilterSampler(const Filter& filter) : radius_(filter.radius()), cells_(cell_count + 1, {1, 1}) {
  CHECK(radius_ > 0 && std::isfinite(radius_), "a filter of radius {}", radius_);
  double sum = 0, signed_sum = 0;
  std::vector<double> partial{0};
  for (int i = 0; i < cell_count; ++i) {
    const float value = filter.value(((float(i) + 0.5f) / float(cell_count) * 2 - 1) * radius_);
    cells_[std::size_t(i)].sign = value < 0 ? -1.f : 1.f;
    signed_sum += double(value);
    partial.push_back(sum += std::abs(double(value)));
  }
  for (int i = 0; i <= cell_count; ++i)
    cells_[std::size_t(i)].begin = sum > 0 ? float(partial[std::size_t(i)] / sum) : float(i) / float(cell_count);
  for (int i = 0, cell = 0; i < step_count; ++i) {
    while (cell + 1 < cell_count && cells_[std::size_t(cell) + 1].begin <= float(i) / float(step_count)) ++cell;
    first_cells_.push_back(std::uint16_t(cell));
  }
  if (sum > 0) mean_weight_ = float((signed_sum / sum) * (signed_sum / sum));  // of a product of two independent signs
}

inline FilterSampler::Sample1D FilterSampler::sample_1d(float random) const {
  const Cell* const cells = cells_.data();
  int cell = first_cells_[std::size_t(std::min(int(random * float(step_count)), step_count - 1))];
  while (cell + 1 < cell_count && cells[cell + 1].begin <= random) ++cell;
  const float low = cells[cell].begin, high = cells[cell + 1].begin;
  const float inside = high > low ? (random - low) / (high - low) : 0.5f;
  return {((float(cell) + inside) / float(cell_count) * 2 - 1) * radius_, cells[cell].sign};
}

FilterSample FilterSampler::sample(Vec2f random) const {
  const Sample1D x = sample_1d(random.x), y = sample_1d(random.y);
  return {{x.offset, y.offset}, x.sign * y.sign};
}

}  // namespace meristem
