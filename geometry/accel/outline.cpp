#include "geometry/accel/outline.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <smmintrin.h>
#include <vector>

namespace meristem {

namespace {

constexpr float nowhere = std::numeric_limits<float>::infinity();
constexpr float error = 8 * 0x1p-24f;  // of a difference, a division or product, and some
constexpr std::size_t lanes = 4;

// Sorts boxes so that each `group` that follow each other, from the first on, are near each other.
void arrange_in_groups(std::span<Bounds3f> boxes, std::size_t group) {
  if (boxes.size() <= group) return;
  Bounds3f centers;
  for (const Bounds3f& b : boxes) centers.extend(b.center());
  const Vec3f extent = centers.upper - centers.lower;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const std::size_t half = (boxes.size() / 2 + group - 1) / group * group;
  std::ranges::nth_element(boxes, boxes.begin() + std::ptrdiff_t(half), {},
                           [axis](const Bounds3f& b) { return b.lower[axis] + b.upper[axis]; });
  arrange_in_groups(boxes.first(half), group);
  arrange_in_groups(boxes.subspan(half), group);
}

}  // namespace

float earliest_entry(const Bounds3f& box, const RaySpan& ray) {
  float from = ray.t_min, to = ray.t_max;
  for (int i = 0; i < 3; ++i) {
    const float lower = box.lower[i] - ray.origin[i], upper = box.upper[i] - ray.origin[i];
    if (ray.direction[i] == 0) {
      if (lower > 0 || upper < 0) return nowhere;
      continue;
    }
    const float a = lower / ray.direction[i], b = upper / ray.direction[i];
    const float enter = std::min(a, b), leave = std::max(a, b);
    from = std::max(from, enter - std::abs(enter) * error);
    to = std::min(to, leave + std::abs(leave) * error);
  }
  return from > to ? nowhere : from;
}

template <std::size_t count>
Outline::Boxes<count>::Boxes() {
  for (std::size_t axis = 0; axis < 3; ++axis) lower[axis].fill(255), upper[axis].fill(0);
}

Outline::Outline(const Bounds3f& whole, std::span<const Bounds3f> boxes, float margin) {
  const Bounds3f all = whole.inflated(Vec3f(2 * margin));
  std::vector<Bounds3f> arranged(boxes.begin(), boxes.end());
  arrange_in_groups(arranged, group);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int i = int(axis);
    origin_[axis] = all.lower[i];
    step_[axis] = std::max((all.upper[i] - all.lower[i]) / 254, std::numeric_limits<float>::min());
    const auto byte = [](float place) { return std::uint8_t(std::clamp(place, 0.f, 255.f)); };
    for (std::size_t b = 0; b < arranged.size(); ++b) {
      std::uint8_t &lower = boxes_.lower[axis][b], &upper = boxes_.upper[axis][b];
      lower = byte(std::floor((arranged[b].lower[i] - margin - origin_[axis]) / step_[axis]));
      upper = byte(std::ceil((arranged[b].upper[i] + margin - origin_[axis]) / step_[axis]));
      groups_.lower[axis][b / group] = std::min(groups_.lower[axis][b / group], lower);
      groups_.upper[axis][b / group] = std::max(groups_.upper[axis][b / group], upper);
    }
  }
}

// A ray as it meets boxes: a plane at start + step * byte.
class Outline::Slabs {
 public:
  Slabs(const Outline& outline, const RaySpan& ray) : t_min_(_mm_set1_ps(ray.t_min)), t_max_(_mm_set1_ps(ray.t_max)) {
    for (std::size_t i = 0; i < 3; ++i) {
      constexpr float most = 1e30f;  // instead of infinity, for a direction of 0; NaN would be passed over
      const float inverse = std::clamp(1 / ray.direction[int(i)], -most, most);
      const float start = (outline.origin_[i] - ray.origin[int(i)]) * inverse, step = outline.step_[i] * inverse;
      const float slack = error * (std::abs(start) + 255 * std::abs(step));
      axes_[i] = {_mm_set1_ps(start - slack), _mm_set1_ps(start + slack), _mm_set1_ps(step), inverse > 0};
    }
  }

  // Where the ray enters each of the eight boxes from `first` on; infinity for those that it does not.
  template <std::size_t count>
  std::array<float, group> entries(const Boxes<count>& boxes, std::size_t first) const {
    static_assert(group == 2 * lanes);
    std::array<float, group> entries;
    for (std::size_t i = 0; i < group; i += lanes) _mm_storeu_ps(&entries[i], entries_of_four(boxes, first + i));
    return entries;
  }

 private:
  struct Axis {
    __m128 near_start, far_start, step;
    bool ascends;
  };

  template <std::size_t count>
  __m128 entries_of_four(const Boxes<count>& boxes, std::size_t first) const {
    __m128 from = t_min_, to = t_max_;
    for (std::size_t i = 0; i < 3; ++i) {
      const Axis& a = axes_[i];
      const auto reach = [&](__m128 start, const std::array<std::uint8_t, count>& bytes) {
        std::uint32_t four;
        std::memcpy(&four, &bytes[first], lanes);
        const __m128 place = _mm_cvtepi32_ps(_mm_cvtepu8_epi32(_mm_cvtsi32_si128(int(four))));
        return _mm_add_ps(start, _mm_mul_ps(place, a.step));
      };
      from = _mm_max_ps(reach(a.near_start, (a.ascends ? boxes.lower : boxes.upper)[i]), from);
      to = _mm_min_ps(reach(a.far_start, (a.ascends ? boxes.upper : boxes.lower)[i]), to);
    }
    return _mm_blendv_ps(_mm_set1_ps(nowhere), from, _mm_cmple_ps(from, to));
  }

  std::array<Axis, 3> axes_;
  __m128 t_min_, t_max_;
};

float Outline::entry(const RaySpan& ray) const {
  const Slabs slabs(*this, ray);
  const std::array<float, group> of_groups = slabs.entries(groups_, 0);
  float least = nowhere;
  for (std::size_t g = 0; g < of_groups.size(); ++g)
    if (of_groups[g] < least) least = std::min(least, std::ranges::min(slabs.entries(boxes_, g * group)));
  return least;
}

}  // namespace meristem
