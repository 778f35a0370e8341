#include "geometry/accel/outline.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <smmintrin.h>

namespace meristem {

namespace {

constexpr float nowhere = std::numeric_limits<float>::infinity();
constexpr float error = 8 * 0x1p-24f;  // of a difference, a division or product, and some
constexpr std::size_t lanes = 4;

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

Outline::Outline(const Bounds3f& whole, std::span<const Bounds3f> boxes, float margin)
    : count_(std::uint32_t(boxes.size())) {
  const Bounds3f all = whole.inflated(Vec3f(2 * margin));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int i = int(axis);
    origin_[axis] = all.lower[i];
    step_[axis] = std::max((all.upper[i] - all.lower[i]) / 254, std::numeric_limits<float>::min());
    const auto byte = [](float place) { return std::uint8_t(std::clamp(place, 0.f, 255.f)); };
    lower_[axis].fill(255);  // those that fill the last four are empty
    for (std::size_t b = 0; b < boxes.size(); ++b) {
      lower_[axis][b] = byte(std::floor((boxes[b].lower[i] - margin - origin_[axis]) / step_[axis]));
      upper_[axis][b] = byte(std::ceil((boxes[b].upper[i] + margin - origin_[axis]) / step_[axis]));
    }
  }
}

float Outline::entry(const RaySpan& ray) const {
  // A plane is met at start + step * byte
  struct Axis {
    __m128 near_start, far_start, step;
    const std::uint8_t *near, *far;
  };
  std::array<Axis, 3> axes;
  for (std::size_t i = 0; i < 3; ++i) {
    constexpr float most = 1e30f;  // instead of infinity, for a direction of 0; NaN would be passed over
    const float inverse = std::clamp(1 / ray.direction[int(i)], -most, most);
    const float start = (origin_[i] - ray.origin[int(i)]) * inverse, step = step_[i] * inverse;
    const float slack = error * (std::abs(start) + 255 * std::abs(step));
    axes[i] = {_mm_set1_ps(start - slack), _mm_set1_ps(start + slack), _mm_set1_ps(step),
               (inverse > 0 ? lower_ : upper_)[i].data(), (inverse > 0 ? upper_ : lower_)[i].data()};
  }
  const __m128 t_min = _mm_set1_ps(ray.t_min), t_max = _mm_set1_ps(ray.t_max), none = _mm_set1_ps(nowhere);
  __m128 least = none;
  for (std::size_t first = 0; first < count_; first += lanes) {
    __m128 from = t_min, to = t_max;
    for (const Axis& a : axes) {
      const auto reach = [&](__m128 start, const std::uint8_t* bytes) {
        std::uint32_t four;
        std::memcpy(&four, bytes + first, lanes);
        const __m128 place = _mm_cvtepi32_ps(_mm_cvtepu8_epi32(_mm_cvtsi32_si128(int(four))));
        return _mm_add_ps(start, _mm_mul_ps(place, a.step));
      };
      from = _mm_max_ps(reach(a.near_start, a.near), from);
      to = _mm_min_ps(reach(a.far_start, a.far), to);
    }
    least = _mm_min_ps(least, _mm_blendv_ps(none, from, _mm_cmple_ps(from, to)));
  }
  least = _mm_min_ps(least, _mm_movehl_ps(least, least));
  return std::min(_mm_cvtss_f32(least), _mm_cvtss_f32(_mm_shuffle_ps(least, least, 1)));
}

}  // namespace meristem
