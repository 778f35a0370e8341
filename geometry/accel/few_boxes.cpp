#include "geometry/accel/few_boxes.h"

#include "geometry/base/check.h"

#include <emmintrin.h>

#include <bit>
#include <limits>

namespace meristem {

FewBoxes::FewBoxes(std::span<const Bounds3f> boxes) : count_(boxes.size()), fours_((boxes.size() + 3) / 4, Four{}) {
  CHECK(boxes.size() <= most, "{} boxes are not few", boxes.size());
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (Four& four : fours_)
    for (float& t : four.last_t) t = -infinity;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].empty()) continue;
    Four& four = fours_[i / 4];
    for (int axis = 0; axis < 3; ++axis) {
      four.planes[axis][0][i % 4] = boxes[i].lower[axis];
      four.planes[axis][1][i % 4] = boxes[i].upper[axis];
    }
    four.last_t[i % 4] = infinity;
  }
}

std::vector<Bounds3f> FewBoxes::boxes() const {
  std::vector<Bounds3f> boxes(count_);
  for (std::size_t i = 0; i < count_; ++i) {
    const Four& four = fours_[i / 4];
    if (four.last_t[i % 4] < 0) continue;
    for (int axis = 0; axis < 3; ++axis) {
      boxes[i].lower[axis] = four.planes[axis][0][i % 4];
      boxes[i].upper[axis] = four.planes[axis][1][i % 4];
    }
  }
  return boxes;
}

std::size_t FewBoxes::meet(const TreeRay& ray, float t_min, float t_max, List& entered) const {
  std::size_t count = 0;
  const __m128 first = _mm_set1_ps(t_min), last = _mm_set1_ps(t_max);
  for (std::size_t i = 0; i < fours_.size(); ++i) {
    const Four& four = fours_[i];
    __m128 enter = first, leave = _mm_min_ps(last, _mm_load_ps(four.last_t));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const __m128 origin = _mm_set1_ps(ray.origin[axis]), reciprocal = _mm_set1_ps(ray.reciprocal[axis]),
                   slack = _mm_set1_ps(ray.slack[axis]), sign = _mm_set1_ps(-0.f);
      const std::uint32_t near_side = ray.near_side[axis];
      const __m128 near_plane = _mm_sub_ps(_mm_load_ps(four.planes[axis][near_side]), origin),
                   far_plane = _mm_sub_ps(_mm_load_ps(four.planes[axis][1 - near_side]), origin);
      enter = _mm_max_ps(
          enter, _mm_sub_ps(_mm_mul_ps(near_plane, reciprocal), _mm_mul_ps(_mm_andnot_ps(sign, near_plane), slack)));
      leave = _mm_min_ps(
          leave, _mm_add_ps(_mm_mul_ps(far_plane, reciprocal), _mm_mul_ps(_mm_andnot_ps(sign, far_plane), slack)));
    }
    alignas(16) float t[4];
    _mm_store_ps(t, enter);
    for (auto met = unsigned(_mm_movemask_ps(_mm_cmple_ps(enter, leave))); met; met &= met - 1) {
      const auto k = std::uint32_t(std::countr_zero(met));
      entered[count++] = {t[k], std::uint32_t(4 * i) + k};
    }
  }
  return count;
}

}  // namespace meristem
