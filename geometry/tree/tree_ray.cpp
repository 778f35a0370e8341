#include "geometry/tree/surface_tree.h"

#include <emmintrin.h>

namespace meristem {

namespace {

// A direction along an axis is taken as this much of the longest at least, so that its reciprocal is finite.
constexpr float least_share = 1e-20f;

// Of the plane of a box: its distance, the reciprocal, their product, that of the step, and the sum each round, 2^-24
// relative to distance and size of the node; the rest is for the t of a hit, which has rounded as well.
constexpr float slack_of_plane = 0x1p-20f;

}  // namespace

// Without branches: directions are random.
TreeRay::TreeRay(Vec3f o, Vec3f d) : origin{o.x, o.y, o.z, 0} {
  const float cyclic[] = {d.x, d.y, d.z, d.x, d.y};
  const Vec3f magnitude = abs(d);
  const float of_xy = std::max(magnitude.x, magnitude.y), longest = std::max(of_xy, magnitude.z);
  axis = magnitude.z > of_xy ? 2 : int(magnitude.y > magnitude.x);

  const __m128 direction = _mm_setr_ps(d.x, d.y, d.z, 1), sign = _mm_and_ps(direction, _mm_set1_ps(-0.f));
  const __m128 finite = _mm_max_ps(_mm_andnot_ps(_mm_set1_ps(-0.f), direction), _mm_set1_ps(longest * least_share));
  const __m128 inverse = _mm_div_ps(_mm_set1_ps(1), finite);
  _mm_store_ps(reciprocal.data(), _mm_or_ps(inverse, sign));
  _mm_store_ps(slack.data(), _mm_mul_ps(inverse, _mm_set1_ps(slack_of_plane)));
  const auto is_negative = std::uint32_t(_mm_movemask_ps(direction));
  for (std::uint32_t i = 0; i < 3; ++i) near_side[i] = is_negative >> i & 1;

  alignas(16) float shears[4];
  _mm_store_ps(shears, _mm_div_ps(_mm_setr_ps(cyclic[axis + 1], cyclic[axis + 2], 1, 1), _mm_set1_ps(cyclic[axis])));
  shear_x = shears[0];
  shear_y = shears[1];
  shear_z = shears[2];
}

}  // namespace meristem
