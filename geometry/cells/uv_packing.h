// u, v of a surface on 16 bits each, without loss: its grids and triangles share one frame (packing.h), or as few as
// hold them all.
#pragma once

#include "geometry/cells/tessellation.h"
#include "geometry/cells/uv_lattice.h"

#include <emmintrin.h>
#include <span>

namespace meristem {

// What a frame must hold: the least and the most of some u, v, and the finest binary digit that any of them has.
class UvRange {
 public:
  void add(Vec2f uv) {
    const __m128d fixed = _mm_add_pd(_mm_cvtps_pd(load_uv(uv)), _mm_set1_pd(offset));
    low_ = _mm_min_pd(low_, fixed);
    high_ = _mm_max_pd(high_, fixed);
    digits_ = _mm_or_pd(digits_, fixed);
  }
  void add(const UvRange& r) {
    low_ = _mm_min_pd(low_, r.low_);
    high_ = _mm_max_pd(high_, r.high_);
    digits_ = _mm_or_pd(digits_, r.digits_);
  }

  // Whether one frame holds them without loss,
  bool fits() const;
  // and that frame; if there is none, one that loses some.
  UvFrame frame() const;

 private:
  // Makes an integer of a double's mantissa: the value in steps of 2^-36, which is the grid of u, v (quantum.h), of up
  // to 2^15. That it is not longer in use shows by its exponent.
  static constexpr double offset = 0x1.8p16;

  __m128d low_ = _mm_set1_pd(0x1p1000), high_ = _mm_set1_pd(-0x1p1000), digits_ = _mm_setzero_pd();
};

// Sets the u, v of all vertices, and the frames by which `out.leaves` say what they mean: leaves are added for further
// frames, and vertices that triangles with several frames share are doubled. `of_grids`: of the vertices of each.
void pack_uv(std::vector<Vec2f>& vertex_uv, std::span<const UvRange> of_grids, Tessellation& out);

// Of all vertices of a tessellation.
std::vector<Vec2f> vertex_uv(const Tessellation& t);

}  // namespace meristem
