// PositionView: where the vertices of a surface lie, as floats or on 16 bits an axis. Plain data; any thread.
#pragma once

#include "geometry/base/vec.h"

#include <cstddef>
#include <cstdint>
#include <smmintrin.h>

namespace meristem {

struct PositionView {
  PositionView() = default;
  // Floats.
  PositionView(const Vec3f* positions) : data(positions) {}
  // Three numbers a vertex of how many steps it lies from the origin: a power of two, and no sum is rounded.
  PositionView(const std::uint16_t* numbers, Vec3f lattice_origin, float lattice_step)
      : data(numbers), lattice{lattice_origin.x, lattice_origin.y, lattice_origin.z, lattice_step} {}

  bool is_packed() const { return step() > 0; }
  float step() const { return lattice[3]; }
  std::size_t bytes_a_vertex() const { return is_packed() ? packed_bytes : sizeof(Vec3f); }
  const char* address(std::size_t vertex) const { return static_cast<const char*>(data) + bytes_a_vertex() * vertex; }
  // x, y, z in lanes; the fourth is not used. Of the last vertex 16 bytes are read, or 8 if they are packed.
  __m128 lanes(std::size_t vertex) const {
    const char* const at = address(vertex);
    if (!is_packed()) return _mm_loadu_ps(reinterpret_cast<const float*>(at));
    const __m128i numbers = _mm_cvtepu16_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(at)));
    return _mm_add_ps(_mm_mul_ps(_mm_cvtepi32_ps(numbers), _mm_set1_ps(step())), _mm_loadu_ps(lattice));
  }
  Vec3f operator[](std::size_t vertex) const {
    alignas(16) float p[4];
    _mm_store_ps(p, lanes(vertex));
    return {p[0], p[1], p[2]};
  }

  static constexpr std::size_t packed_bytes = 6;
  const void* data = nullptr;
  float lattice[4] = {0, 0, 0, 0};  // the origin and the step; 0: floats
};

}  // namespace meristem
