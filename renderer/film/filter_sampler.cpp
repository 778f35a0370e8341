#include "renderer/film/filter_sampler.h"

#include "geometry/base/check.h"

#include <algorithm>

namespace meristem {

namespace {

constexpr std::size_t cell_count = 1024;  // even, so that no cell straddles the centre
constexpr std::size_t step_count = 4 * cell_count;

}  // namespace

FilterSampler::FilterSampler(const Filter& filter)
    : radius_(filter.radius()), values_(cell_count), cumulative_(cell_count + 1) {
  CHECK(radius_ > 0 && std::isfinite(radius_), "a filter of radius {}", radius_);
  double sum = 0, signed_sum = 0;
  std::vector<double> partial{0};
  for (std::size_t i = 0; i < cell_count; ++i) {
    values_[i] = filter.value(((float(i) + 0.5f) / float(cell_count) * 2 - 1) * radius_);
    signed_sum += double(values_[i]);
    partial.push_back(sum += std::abs(double(values_[i])));
  }
  for (std::size_t i = 0; i <= cell_count; ++i)
    cumulative_[i] = sum > 0 ? float(partial[i] / sum) : float(i) / float(cell_count);
  for (std::size_t i = 0, cell = 0; i < step_count; ++i) {
    while (cell + 1 < cell_count && cumulative_[cell + 1] <= float(i) / float(step_count)) ++cell;
    first_cells_.push_back(std::uint16_t(cell));
  }
  if (sum > 0) mean_weight_ = float((signed_sum / sum) * (signed_sum / sum));  // of a product of two independent signs
}

FilterSampler::Sample1D FilterSampler::sample_1d(float random) const {
  std::size_t cell = first_cells_[std::min(std::size_t(random * float(step_count)), step_count - 1)];
  while (cell + 1 < cell_count && cumulative_[cell + 1] <= random) ++cell;
  const float low = cumulative_[cell], high = cumulative_[cell + 1];
  const float inside = high > low ? (random - low) / (high - low) : 0.5f;
  return {((float(cell) + inside) / float(cell_count) * 2 - 1) * radius_, values_[cell] < 0 ? -1.0f : 1.0f};
}

FilterSample FilterSampler::sample(Vec2f random) const {
  const Sample1D x = sample_1d(random.x), y = sample_1d(random.y);
  return {{x.offset, y.offset}, x.sign * y.sign};
}

}  // namespace meristem
