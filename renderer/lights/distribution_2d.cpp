#include "renderer/lights/distribution_2d.h"

#include "geometry/base/check.h"

#include <numeric>

namespace meristem {
namespace {

// Turns weights into their running sum divided by the total, which is returned. Equal steps if the total is zero.
double accumulate(std::vector<double>::iterator first, std::vector<double>::iterator last) {
  const double total = std::accumulate(first, last, 0.0);
  const double count = double(last - first);
  double sum = 0;
  for (auto i = first; i != last; ++i) {
    sum += total > 0 ? *i / total : 1 / count;
    *i = sum;
  }
  *(last - 1) = 1;
  return total;
}

// Equal parts of [0, 1), each of some four steps of a running sum, which lie in one cache line.
int parts_of(int count) { return (count + 3) / 4; }

// In which step of a running sum each part begins: appended to `firsts`.
void append_firsts(const double* ends, int count, std::vector<std::uint32_t>& firsts) {
  const int parts = parts_of(count);
  for (int part = 0, i = 0; part < parts; ++part) {
    while (i + 1 < count && ends[i] <= double(part) / parts) ++i;
    firsts.push_back(std::uint32_t(i));
  }
}

// The step of a running sum that a uniform number falls in, and where inside it, in [0, 1).
int pick(const double* ends, const std::uint32_t* firsts, int count, double random, float& inside) {
  const int parts = parts_of(count), part = std::min(int(random * parts), parts - 1);
  const int first = int(firsts[part]), last = part + 1 < parts ? int(firsts[part + 1]) : count - 1;
  const int i = std::min(int(std::upper_bound(ends + first, ends + last + 1, random) - ends), last);
  const double start = i > 0 ? ends[i - 1] : 0;
  inside = std::min(float((random - start) / (ends[i] - start)), 0x1.fffffep-1f);
  return i;
}

int cell_of(float x, int count) { return std::clamp(int(x * float(count)), 0, count - 1); }

}  // namespace

Distribution2D::Distribution2D(std::vector<float> weights, int width, int height)
    : width_(width), height_(height), density_(std::move(weights)) {
  CHECK(width > 0 && height > 0 && density_.size() == std::size_t(width) * std::size_t(height),
        "{} weights for {} x {} cells", density_.size(), width, height);
  cell_ends_.assign(density_.begin(), density_.end());
  for (int y = 0; y < height; ++y) {
    const auto row = cell_ends_.begin() + std::ptrdiff_t(y) * width;
    row_ends_.push_back(accumulate(row, row + width));
    append_firsts(&*row, width, first_cells_);
  }
  const double total = accumulate(row_ends_.begin(), row_ends_.end());
  append_firsts(row_ends_.data(), height, first_rows_);
  for (float& d : density_) d = total > 0 ? float(d * double(density_.size()) / total) : 1.f;
}

Vec2f Distribution2D::sample(Vec2f random) const {
  float in_x = 0, in_y = 0;
  const int y = pick(row_ends_.data(), first_rows_.data(), height_, random.y, in_y);
  const std::ptrdiff_t row = std::ptrdiff_t(y) * width_;
  const int x =
      pick(cell_ends_.data() + row, first_cells_.data() + std::ptrdiff_t(y) * parts_of(width_), width_, random.x, in_x);
  return {(float(x) + in_x) / float(width_), (float(y) + in_y) / float(height_)};
}

float Distribution2D::pdf(Vec2f p) const {
  return density_[std::size_t(cell_of(p.y, height_)) * std::size_t(width_) + std::size_t(cell_of(p.x, width_))];
}

}  // namespace meristem
