#include "geometry/cells/surface_vertices.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace meristem {

namespace {

constexpr float most_steps = 65535;

// The finest step, a power of two, of which none of these is more than so many from another; 0: there is none.
float step_over(const Bounds3f& bounds) {
  const float range = max_component(bounds.upper - bounds.lower);
  if (!(range < 0x1p100f)) return 0;
  if (range == 0) return 1;
  int exponent;
  const bool is_power = std::frexp(range / most_steps, &exponent) == 0.5f;
  const float step = std::ldexp(1.f, is_power ? exponent - 1 : exponent);
  return step >= 0x1p-100f ? step : 0;
}

Bounds3f bounds_of(std::span<const Vec3f> positions) {
  Bounds3f bounds;
  for (const Vec3f& p : positions) bounds.extend(p);
  return bounds;
}

__m128 lanes_of(const Vec3f& p) { return _mm_setr_ps(p.x, p.y, p.z, 0); }

}  // namespace

SurfaceVertices::SurfaceVertices(std::vector<Vec3f> positions, std::span<const PackedAttributes> attributes,
                                 bool has_uv)
    : bounds_(bounds_of(positions)), words_a_vertex_(has_uv ? 2 : 1), size_(positions.size()) {
  attributes_.resize(words_a_vertex_ * attributes.size());
  for (std::size_t v = 0; v < attributes.size(); ++v)
    attributes_[words_a_vertex_ * v] = std::bit_cast<std::uint32_t>(attributes[v].normal);
  for (std::size_t v = 0; has_uv && v < attributes.size(); ++v)
    attributes_[2 * v + 1] = std::bit_cast<std::uint32_t>(attributes[v].uv);
  if (pack(positions)) return;
  if (positions.capacity() == positions.size() + 1) {
    loose_ = std::move(positions);
  } else {
    loose_.reserve(positions.size() + 1);
    loose_.assign(positions.begin(), positions.end());
  }
  loose_.emplace_back();
}

// False if that would lose anything, be it the sign of a zero.
bool SurfaceVertices::pack(std::span<const Vec3f> positions) {
  const float step = step_over(bounds_);
  if (bounds_.empty() || step == 0) return false;
  const __m128 origin = lanes_of(bounds_.lower), steps = _mm_set1_ps(step), per_step = _mm_set1_ps(1 / step);
  packed_.resize(3 * positions.size() + 1);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const __m128 p = lanes_of(positions[v]);
    const __m128i numbers = _mm_cvtps_epi32(_mm_mul_ps(_mm_sub_ps(p, origin), per_step));
    const __m128 unpacked = _mm_add_ps(_mm_mul_ps(_mm_cvtepi32_ps(numbers), steps), origin);
    const __m128i is_same = _mm_cmpeq_epi32(_mm_castps_si128(unpacked), _mm_castps_si128(p));
    if ((_mm_movemask_ps(_mm_castsi128_ps(is_same)) & 7) != 7) {
      std::vector<std::uint16_t>().swap(packed_);
      return false;
    }
    const auto three = std::uint64_t(_mm_cvtsi128_si64(_mm_packus_epi32(numbers, numbers)));
    std::memcpy(&packed_[3 * v], &three, sizeof three);  // and what the next one overwrites
  }
  lattice_step_ = step;
  return true;
}

std::size_t SurfaceVertices::bytes() const {
  return loose_.capacity() * sizeof(Vec3f) + packed_.capacity() * 2 + attributes_.capacity() * 4;
}

void SurfaceVertices::set_layout(const Layout& layout) {
  bounds_ = layout.bounds;
  lattice_step_ = layout.lattice_step;
  words_a_vertex_ = layout.words_a_vertex;
  size_ = layout.size;
}

}  // namespace meristem
