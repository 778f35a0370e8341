// UvLattice: what u, v of a vertex are rounded to where it is shown.
//
// A surface keeps them on 16 bits each. Steps of a cell's range would show where a model was cut into cells. So they
// are rounded before, to multiples of a power of two that follows from the vertex alone: 512 to 1023 of them to the
// widest face that meets there on the level at which the vertex is shown; no more than 2^-15 apart, which is a quarter
// of a pixel of a texture of 8192; and at least 2^15 to a face. Values of so few digits are packed without loss
// (uv_packing.h), whatever cell they stand in.
#pragma once

#include "geometry/base/scratch.h"
#include "geometry/mesh/mesh.h"

#include <emmintrin.h>
#include <span>

namespace meristem {

// u and v in the first two lanes, zero in the others.
inline __m128 load_uv(const Vec2f& uv) { return _mm_loadl_pi(_mm_setzero_ps(), reinterpret_cast<const __m64*>(&uv.x)); }
inline void store_uv(Vec2f& uv, __m128 lanes) { _mm_storel_pi(reinterpret_cast<__m64*>(&uv.x), lanes); }

// On the lattice of faces that are so wide in u and v (zero: it does not vary).
inline Vec2f on_uv_lattice(Vec2f uv, Vec2f width) {
  const __m128 power = _mm_and_ps(load_uv(width), _mm_castsi128_ps(_mm_set1_epi32(0x7f800000)));
  const __m128 coarsest = _mm_set1_ps(0x1p-15f), is_constant = _mm_cmpeq_ps(power, _mm_setzero_ps());
  const __m128 fine =
      _mm_or_ps(_mm_min_ps(_mm_mul_ps(power, _mm_set1_ps(0x1p-9f)), coarsest), _mm_and_ps(is_constant, coarsest));
  const __m128 least = _mm_max_ps(_mm_mul_ps(power, _mm_set1_ps(0x1p-15f)), _mm_set1_ps(0x1p-36f));
  const __m128d step = _mm_cvtps_pd(_mm_max_ps(fine, least));
  const __m128d magic = _mm_mul_pd(step, _mm_set1_pd(0x1.8p52));
  const __m128d rounded = _mm_sub_pd(_mm_add_pd(_mm_cvtps_pd(load_uv(uv)), magic), magic);
  Vec2f result;
  store_uv(result, _mm_cvtpd_ps(rounded));
  return result;
}

class UvLattice {
 public:
  // Of a mesh whose u, v by vertex are `uv` (vertex_uv()). Linear; some 5 ns a face.
  UvLattice(const Mesh& mesh, std::span<const Vec2d> uv);

  // For vertices all of whose faces are in the mesh.
  Vec2f round(std::uint32_t vertex, Vec2f uv) const { return on_uv_lattice(uv, widths_[vertex]); }

 private:
  Scratch<Vec2f> widths_;
};

}  // namespace meristem
