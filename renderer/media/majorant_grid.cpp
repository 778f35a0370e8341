#include "renderer/media/majorant_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meristem {

MajorantGrid::MajorantGrid(const Bounds3f& box, int cells, const std::function<float(const Bounds3d&)>& bound)
    : box_(box) {
  constexpr int most_along_an_axis = 256;
  const Vec3d extent(box.size());
  const double side = std::cbrt(extent.x * extent.y * extent.z / cells);
  for (int c = 0; c < 3; ++c) {
    size_[std::size_t(c)] = std::clamp(int(std::lround(extent[c] / side)), 1, most_along_an_axis);
    cell_size_[c] = float(extent[c] / size_[std::size_t(c)]);
  }
  const Vec3d step(cell_size_), corner(box.lower);
  // Points of a walk may round out of their cell
  const Vec3d slack = step * 1e-4 + Vec3d(max_component(max(abs(corner), abs(Vec3d(box.upper)))) * 1e-5);
  for (int x = 0; x < size_[0]; ++x)
    for (int y = 0; y < size_[1]; ++y)
      for (int z = 0; z < size_[2]; ++z) {
        const Vec3d lower = corner + step * Vec3d(x, y, z);
        majorants_.push_back(bound(Bounds3d{lower, lower + step}.inflated(slack)));
      }
}

float MajorantGrid::largest() const { return majorants_.empty() ? 0 : *std::ranges::max_element(majorants_); }

TentativeCollisions::TentativeCollisions(const MajorantGrid& grid, const Ray& ray) : grid_(grid) {
  double start = std::max(double(ray.t_min), 0.0), end = double(ray.t_max);
  for (int c = 0; c < 3; ++c) {
    const double o = double(ray.origin[c]), d = double(ray.direction[c]);
    if (d == 0) {
      if (o < double(grid.box_.lower[c]) || o > double(grid.box_.upper[c])) return;
      continue;
    }
    const double a = (double(grid.box_.lower[c]) - o) / d, b = (double(grid.box_.upper[c]) - o) / d;
    start = std::max(start, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  if (!(start < end)) return;
  end_ = end;
  enter(ray, start);
}

void TentativeCollisions::enter(const Ray& ray, double start) {
  t_ = start;
  for (int c = 0; c < 3; ++c) {
    const auto i = std::size_t(c);
    const double d = double(ray.direction[c]), lower = double(grid_.box_.lower[c]), size = double(grid_.cell_size_[c]);
    const double place = (double(ray.origin[c]) + d * start - lower) / size;
    cell_[i] = std::clamp(int(std::floor(place)), 0, grid_.size_[i] - 1);
    step_[i] = d > 0 ? 1 : -1;
    delta_[i] = d == 0 ? std::numeric_limits<double>::infinity() : size / std::abs(d);
    next_[i] = d == 0 ? delta_[i] : (lower + size * (cell_[i] + (d > 0 ? 1 : 0)) - double(ray.origin[c])) / d;
  }
  cell_end_ = std::min({next_[0], next_[1], next_[2], end_});
}

bool TentativeCollisions::leave_cell() {
  t_ = std::max(t_, cell_end_);
  if (t_ >= end_) return false;
  const std::size_t axis = next_[0] <= next_[1] ? (next_[0] <= next_[2] ? 0 : 2) : (next_[1] <= next_[2] ? 1 : 2);
  cell_[axis] += step_[axis];
  if (cell_[axis] < 0 || cell_[axis] >= grid_.size_[axis]) return false;
  next_[axis] += delta_[axis];
  cell_end_ = std::min({next_[0], next_[1], next_[2], end_});
  return true;
}

bool TentativeCollisions::next(RandomStream& random, float& t, float& majorant) {
  if (!(t_ < end_)) return false;
  double depth = -std::log1p(-double(random.next()));  // optical, by the majorants
  for (;;) {
    const double density = double(grid_.at(cell_));
    const double room = (cell_end_ - t_) * density;
    if (depth < room) {
      t_ += depth / density;
      t = float(t_);
      majorant = float(density);
      return true;
    }
    depth -= std::max(room, 0.0);
    if (!leave_cell()) {
      t_ = end_;
      return false;
    }
  }
}

}  // namespace meristem
