#include "geometry/volumes/brick_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace meristem {

namespace {

constexpr int side = VoxelSource::block_side, row = VoxelSource::row;
constexpr std::uint32_t block_values = std::uint32_t(VoxelSource::block_values);

int aligned(int i) { return i & ~(side - 1); }

float lerp_sample(float a, float b, float t) { return a + (b - a) * t; }

Interval hull(Interval a, Interval b) { return {std::min(a.lower, b.lower), std::max(a.upper, b.upper)}; }

// What interpolation in floats may give between samples of the interval: three nested steps of a few ulps.
Interval interpolated(Interval i) {
  const float margin = 2e-6f * std::max(std::abs(i.lower), std::abs(i.upper)) + 1e-37f;
  return {i.lower - margin, i.upper + margin};
}

}  // namespace

BrickGrid::BrickGrid(const VoxelSource& source)
    : index_from_world_(source.world_from_index.inverse()),
      world_from_index_(source.world_from_index),
      spacing_(std::cbrt(std::abs(source.world_from_index.determinant()))),
      background_(source.background),
      lower_(source.lower),
      upper_(source.upper),
      base_{} {
  if (!std::isfinite(background_) || !std::isfinite(spacing_) || !(spacing_ > 0))
    throw std::runtime_error("its transform or background is not finite");
  if (lower_[0] > upper_[0]) return;  // empty: background everywhere
  std::size_t bricks = 1;
  Level level;
  for (std::size_t c = 0; c < 3; ++c) {
    constexpr int largest = 1 << 30;
    if (lower_[c] < -largest || upper_[c] > largest)
      throw std::runtime_error("its samples lie too far from its origin");
    --lower_[c];
    base_[c] = aligned(lower_[c]);
    level.size[c] = (aligned(upper_[c]) - base_[c]) / side + 1;
    bricks *= std::size_t(level.size[c]);
    if (bricks > VoxelSource::max_blocks)
      throw std::runtime_error(fmt::format("the box of its samples holds more than {} million samples",
                                           (VoxelSource::max_blocks >> 20) * std::size_t(side * side * side)));
  }
  directory_.resize(bricks);
  level.cells.resize(bricks);
  pyramid_.push_back(std::move(level));
  read(source);
  build_pyramid();
}

void BrickGrid::read(const VoxelSource& source) {
  Level& level = pyramid_.front();
  for (int x = 0; x < level.size[0]; ++x)
    for (int y = 0; y < level.size[1]; ++y)
      for (int z = 0; z < level.size[2]; ++z) {
        const std::size_t i = cell(level, x, y, z);
        level.cells[i] = add_brick(source, i, {base_[0] + x * side, base_[1] + y * side, base_[2] + z * side});
      }
  values_.shrink_to_fit();
}

Interval BrickGrid::add_brick(const VoxelSource& source, std::size_t index, VoxelIndex origin) {
  std::array<float, block_values> block;
  Interval range;
  if (float value = 0; source.is_constant(origin, value)) {
    range = {value, value};
  } else {
    source.read_block(origin, block.data());
    const auto [least, most] = std::ranges::minmax(block);
    range = {least, most};
    if (!std::ranges::all_of(block, [](float v) { return std::isfinite(v); }))
      throw std::runtime_error("it holds values that are not finite");
  }
  if (range.lower == range.upper) {
    if (constants_.empty() || constants_.back() != range.lower) constants_.push_back(range.lower);
    directory_[index] = constant_bit + std::uint32_t(constants_.size() - 1);
  } else {
    if (values_.size() / block_values >= VoxelSource::max_uneven_blocks)
      throw std::runtime_error(fmt::format("it holds more than {} million samples",
                                           (VoxelSource::max_uneven_blocks >> 20) * std::size_t(side * side * side)));
    directory_[index] = std::uint32_t(values_.size());
    values_.insert(values_.end(), block.begin(), block.end());
  }
  return range;
}

void BrickGrid::build_pyramid() {
  while (pyramid_.back().cells.size() > 1) {
    const Level& fine = pyramid_.back();
    Level coarse;
    for (std::size_t c = 0; c < 3; ++c) coarse.size[c] = (fine.size[c] + 1) / 2;
    coarse.cells.assign(std::size_t(coarse.size[0]) * std::size_t(coarse.size[1]) * std::size_t(coarse.size[2]),
                        {INFINITY, -INFINITY});
    for (int x = 0; x < fine.size[0]; ++x)
      for (int y = 0; y < fine.size[1]; ++y)
        for (int z = 0; z < fine.size[2]; ++z) {
          Interval& to = coarse.cells[cell(coarse, x / 2, y / 2, z / 2)];
          to = hull(to, fine.cells[cell(fine, x, y, z)]);
        }
    pyramid_.push_back(std::move(coarse));
  }
}

float BrickGrid::value(Vec3f place) const {
  const Vec3d p = index_from_world_.point(Vec3d(place));
  VoxelIndex in_brick{};
  Vec3f t;
  std::size_t brick = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double at = p[int(c)], first = std::floor(at);
    if (!(first >= lower_[c] && first <= upper_[c])) return background_;
    const int i = int(first) - base_[c];
    brick = brick * std::size_t(pyramid_.front().size[c]) + std::size_t(i / side);
    in_brick[c] = i % side;
    t[int(c)] = float(at - first);
  }
  const std::uint32_t entry = directory_[brick];
  if (entry >= constant_bit) return constants_[entry - constant_bit];
  const float* v = values_.data() + entry + (in_brick[0] * row + in_brick[1]) * row + in_brick[2];
  auto along_z = [&](const float* w) { return lerp_sample(w[0], w[1], t.z); };
  auto along_y = [&](const float* w) { return lerp_sample(along_z(w), along_z(w + row), t.y); };
  return lerp_sample(along_y(v), along_y(v + row * row), t.x);
}

Vec3f BrickGrid::gradient(Vec3f place) const {
  const float h = float(spacing_), factor = 1 / (2 * h);
  Vec3f result;
  for (int c = 0; c < 3; ++c) {
    Vec3f before = place, after = place;
    before[c] -= h;
    after[c] += h;
    result[c] = (value(after) - value(before)) * factor;
  }
  return result;
}

float BrickGrid::sample(int x, int y, int z) const {
  const Level& bricks = pyramid_.front();
  x -= base_[0], y -= base_[1], z -= base_[2];
  // The last layer belongs to the last brick's own neighbours
  const int bx = std::min(x / side, bricks.size[0] - 1), by = std::min(y / side, bricks.size[1] - 1),
            bz = std::min(z / side, bricks.size[2] - 1);
  const std::uint32_t entry = directory_[cell(bricks, bx, by, bz)];
  if (entry >= constant_bit) return constants_[entry - constant_bit];
  return values_[entry + std::uint32_t(((x - bx * side) * row + y - by * side) * row + z - bz * side)];
}

Interval BrickGrid::exact_bounds(VoxelIndex first, VoxelIndex last) const {
  Interval range{INFINITY, -INFINITY};
  for (int x = first[0]; x <= last[0] + 1; ++x)
    for (int y = first[1]; y <= last[1] + 1; ++y)
      for (int z = first[2]; z <= last[2] + 1; ++z) {
        const float v = sample(x, y, z);
        range = hull(range, {v, v});
      }
  return range;
}

Interval BrickGrid::pyramid_bounds(VoxelIndex first, VoxelIndex last) const {
  constexpr int most_steps = 4;  // between cells along an axis
  for (std::size_t c = 0; c < 3; ++c) {
    first[c] = (first[c] - base_[c]) / side;
    last[c] = (last[c] - base_[c]) / side;
  }
  std::size_t level = 0;
  auto is_wide = [&](std::size_t c) { return (last[c] >> level) - (first[c] >> level) > most_steps; };
  while (is_wide(0) || is_wide(1) || is_wide(2)) ++level;
  Interval range{INFINITY, -INFINITY};
  for (int x = first[0] >> level; x <= last[0] >> level; ++x)
    for (int y = first[1] >> level; y <= last[1] >> level; ++y)
      for (int z = first[2] >> level; z <= last[2] >> level; ++z)
        range = hull(range, pyramid_[level].cells[cell(pyramid_[level], x, y, z)]);
  return range;
}

Interval BrickGrid::value_bounds(const Bounds3d& box) const {
  const Interval outside{background_, background_};
  if (directory_.empty()) return outside;
  const Bounds3d places = index_from_world_.bounds(box);
  VoxelIndex first{}, last{};
  bool leaves = false;
  for (std::size_t c = 0; c < 3; ++c) {
    const double from = places.lower[int(c)], to = places.upper[int(c)];
    const double slack = 1e-9 * (1 + std::max(std::abs(from), std::abs(to)));
    const double f = std::floor(from - slack), l = std::floor(to + slack);
    if (!(l >= lower_[c] && f <= upper_[c])) return outside;
    leaves = leaves || f < lower_[c] || l > upper_[c];
    first[c] = int(std::max(f, double(lower_[c])));
    last[c] = int(std::min(l, double(upper_[c])));
  }
  constexpr std::size_t few = 64;
  const auto count = [&](std::size_t c) { return std::size_t(last[c] - first[c] + 1); };
  const Interval inside =
      count(0) * count(1) * count(2) <= few ? exact_bounds(first, last) : pyramid_bounds(first, last);
  return interpolated(leaves ? hull(inside, outside) : inside);
}

Interval BrickGrid::gradient_bounds(const Bounds3d& box) const {
  const double magnitude = max_component(max(abs(box.lower), abs(box.upper)));
  const Interval r = value_bounds(box.inflated(Vec3d(spacing_ * 1.000001 + magnitude * 1e-6)));
  const float steepest = (r.upper - r.lower) / float(2 * spacing_) * 1.00001f;
  return {-steepest, steepest};
}

Bounds3d BrickGrid::bounds() const {
  if (directory_.empty()) return {};
  auto corner = [](VoxelIndex i, int more) { return Vec3d(i[0] + more, i[1] + more, i[2] + more); };
  return world_from_index_.bounds({corner(lower_, 0), corner(upper_, 1)});
}

std::size_t BrickGrid::bytes() const {
  std::size_t sum = sizeof(*this) + (directory_.size() + values_.size() + constants_.size()) * sizeof(float);
  for (const Level& level : pyramid_) sum += level.cells.size() * sizeof(Interval);
  return sum;
}

}  // namespace meristem
