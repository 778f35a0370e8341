// The bodies of the kernels, for 8 lanes of AVX2 or twice 4 of SSE. Products and sums of a triangle are not fused: the
// bits of a hit are the same with both.
//
// Only for the tree_kernels_*.cpp files, which define MERISTEM_TREE_AVX2 first; everything is local to them.
#pragma once

#include "geometry/tree/tree_kernels.h"

#include <bit>
#include <immintrin.h>

// After the includes: inline functions of other headers must stay at the baseline.
#if MERISTEM_TREE_AVX2
#pragma GCC target("avx2,fma,bmi,bmi2,popcnt")
#endif

namespace meristem {
namespace {

#define MERISTEM_INLINE [[gnu::always_inline]] inline

#if MERISTEM_TREE_AVX2
typedef __m256 F8;
MERISTEM_INLINE F8 splat(float v) { return _mm256_set1_ps(v); }
MERISTEM_INLINE F8 min(F8 a, F8 b) { return _mm256_min_ps(a, b); }
MERISTEM_INLINE F8 max(F8 a, F8 b) { return _mm256_max_ps(a, b); }
MERISTEM_INLINE F8 add(F8 a, F8 b) { return _mm256_add_ps(a, b); }
MERISTEM_INLINE F8 sub(F8 a, F8 b) { return _mm256_sub_ps(a, b); }
MERISTEM_INLINE F8 mul(F8 a, F8 b) { return _mm256_mul_ps(a, b); }
MERISTEM_INLINE F8 div(F8 a, F8 b) { return _mm256_div_ps(a, b); }
MERISTEM_INLINE F8 mul_add_loose(F8 a, F8 b, F8 c) { return _mm256_fmadd_ps(a, b, c); }  // rounded once or twice
MERISTEM_INLINE unsigned where_le(F8 a, F8 b) { return unsigned(_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ))); }
MERISTEM_INLINE unsigned where_lt(F8 a, F8 b) { return unsigned(_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LT_OQ))); }
MERISTEM_INLINE unsigned where_zero(F8 a) {
  return unsigned(_mm256_movemask_ps(_mm256_cmp_ps(a, _mm256_setzero_ps(), _CMP_EQ_OQ)));
}
MERISTEM_INLINE F8 load(const float* p) { return _mm256_load_ps(p); }
MERISTEM_INLINE void store(float* p, F8 a) { _mm256_storeu_ps(p, a); }
MERISTEM_INLINE __m128 lower(F8 a) { return _mm256_castps256_ps128(a); }
MERISTEM_INLINE __m128 upper(F8 a) { return _mm256_extractf128_ps(a, 1); }
MERISTEM_INLINE F8 join(__m128 low, __m128 high) { return _mm256_insertf128_ps(_mm256_castps128_ps256(low), high, 1); }
MERISTEM_INLINE F8 swap_halves(F8 a) { return _mm256_permute2f128_ps(a, a, 1); }
MERISTEM_INLINE F8 from_bytes(const std::uint8_t* p) {
  return _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p))));
}
// Four numbers for each half.
MERISTEM_INLINE F8 from_words(const std::uint16_t* low, const std::uint16_t* high) {
  const __m128 first = _mm_castsi128_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(low)));
  const __m128 both = _mm_loadh_pi(first, reinterpret_cast<const __m64*>(high));
  return _mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(_mm_castps_si128(both)));
}
template <int I>
MERISTEM_INLINE F8 lane(__m128 a) {
  if constexpr (I == 0) return _mm256_broadcastss_ps(a);
  return _mm256_permutevar8x32_ps(_mm256_castps128_ps256(a), _mm256_set1_epi32(I));
}
// The order of lanes within each half, as bytes.
typedef __m256i LaneOrder;
MERISTEM_INLINE LaneOrder load_order(const std::uint8_t* bytes) {
  return _mm256_broadcastsi128_si256(_mm_load_si128(reinterpret_cast<const __m128i*>(bytes)));
}
MERISTEM_INLINE __m128 ordered(__m128 a, LaneOrder order) {
  return _mm_castsi128_ps(_mm_shuffle_epi8(_mm_castps_si128(a), _mm256_castsi256_si128(order)));
}
MERISTEM_INLINE F8 ordered(F8 a, LaneOrder order) {
  return _mm256_castsi256_ps(_mm256_shuffle_epi8(_mm256_castps_si256(a), order));
}
// In both halves, of four points each: the i-th of all.
MERISTEM_INLINE void transpose(F8 p0, F8 p1, F8 p2, F8 p3, F8 (&out)[3]) {
  const F8 xy01 = _mm256_unpacklo_ps(p0, p1), xy23 = _mm256_unpacklo_ps(p2, p3);
  const F8 z01 = _mm256_unpackhi_ps(p0, p1), z23 = _mm256_unpackhi_ps(p2, p3);
  out[0] = _mm256_shuffle_ps(xy01, xy23, _MM_SHUFFLE(1, 0, 1, 0));
  out[1] = _mm256_shuffle_ps(xy01, xy23, _MM_SHUFFLE(3, 2, 3, 2));
  out[2] = _mm256_shuffle_ps(z01, z23, _MM_SHUFFLE(1, 0, 1, 0));
}
#else
struct F8 {
  __m128 low, high;
};
template <class Operation>
MERISTEM_INLINE F8 both(F8 a, F8 b, const Operation& operation) {
  return {operation(a.low, b.low), operation(a.high, b.high)};
}
MERISTEM_INLINE unsigned bits(F8 mask) {
  return unsigned(_mm_movemask_ps(mask.low)) | unsigned(_mm_movemask_ps(mask.high)) << 4;
}
MERISTEM_INLINE F8 splat(float v) { return {_mm_set1_ps(v), _mm_set1_ps(v)}; }
MERISTEM_INLINE F8 min(F8 a, F8 b) {
  return both(a, b, [](__m128 x, __m128 y) { return _mm_min_ps(x, y); });
}
MERISTEM_INLINE F8 max(F8 a, F8 b) {
  return both(a, b, [](__m128 x, __m128 y) { return _mm_max_ps(x, y); });
}
MERISTEM_INLINE F8 add(F8 a, F8 b) {
  return both(a, b, [](__m128 x, __m128 y) { return _mm_add_ps(x, y); });
}
MERISTEM_INLINE F8 sub(F8 a, F8 b) {
  return both(a, b, [](__m128 x, __m128 y) { return _mm_sub_ps(x, y); });
}
MERISTEM_INLINE F8 mul(F8 a, F8 b) {
  return both(a, b, [](__m128 x, __m128 y) { return _mm_mul_ps(x, y); });
}
MERISTEM_INLINE F8 div(F8 a, F8 b) {
  return both(a, b, [](__m128 x, __m128 y) { return _mm_div_ps(x, y); });
}
MERISTEM_INLINE F8 mul_add_loose(F8 a, F8 b, F8 c) { return add(mul(a, b), c); }
MERISTEM_INLINE unsigned where_le(F8 a, F8 b) {
  return bits(both(a, b, [](__m128 x, __m128 y) { return _mm_cmple_ps(x, y); }));
}
MERISTEM_INLINE unsigned where_lt(F8 a, F8 b) {
  return bits(both(a, b, [](__m128 x, __m128 y) { return _mm_cmplt_ps(x, y); }));
}
MERISTEM_INLINE unsigned where_zero(F8 a) {
  return bits(both(a, splat(0), [](__m128 x, __m128 y) { return _mm_cmpeq_ps(x, y); }));
}
MERISTEM_INLINE F8 load(const float* p) { return {_mm_load_ps(p), _mm_load_ps(p + 4)}; }
MERISTEM_INLINE void store(float* p, F8 a) {
  _mm_storeu_ps(p, a.low);
  _mm_storeu_ps(p + 4, a.high);
}
MERISTEM_INLINE __m128 lower(F8 a) { return a.low; }
MERISTEM_INLINE __m128 upper(F8 a) { return a.high; }
MERISTEM_INLINE F8 join(__m128 low, __m128 high) { return {low, high}; }
MERISTEM_INLINE F8 swap_halves(F8 a) { return {a.high, a.low}; }
MERISTEM_INLINE F8 from_bytes(const std::uint8_t* p) {
  const __m128i b = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(p));
  return {_mm_cvtepi32_ps(_mm_cvtepu8_epi32(b)), _mm_cvtepi32_ps(_mm_cvtepu8_epi32(_mm_srli_si128(b, 4)))};
}
MERISTEM_INLINE F8 from_words(const std::uint16_t* low, const std::uint16_t* high) {
  const auto half = [](const std::uint16_t* p) {
    return _mm_cvtepi32_ps(_mm_cvtepu16_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p))));
  };
  return {half(low), half(high)};
}
template <int I>
MERISTEM_INLINE F8 lane(__m128 a) {
  a = _mm_shuffle_ps(a, a, _MM_SHUFFLE(I, I, I, I));
  return {a, a};
}
typedef __m128i LaneOrder;
MERISTEM_INLINE LaneOrder load_order(const std::uint8_t* bytes) {
  return _mm_load_si128(reinterpret_cast<const __m128i*>(bytes));
}
MERISTEM_INLINE __m128 ordered(__m128 a, LaneOrder order) {
  return _mm_castsi128_ps(_mm_shuffle_epi8(_mm_castps_si128(a), order));
}
MERISTEM_INLINE F8 ordered(F8 a, LaneOrder order) { return {ordered(a.low, order), ordered(a.high, order)}; }
MERISTEM_INLINE void transpose4(__m128 p0, __m128 p1, __m128 p2, __m128 p3, __m128& x, __m128& y, __m128& z) {
  const __m128 xy01 = _mm_unpacklo_ps(p0, p1), xy23 = _mm_unpacklo_ps(p2, p3);
  const __m128 z01 = _mm_unpackhi_ps(p0, p1), z23 = _mm_unpackhi_ps(p2, p3);
  x = _mm_shuffle_ps(xy01, xy23, _MM_SHUFFLE(1, 0, 1, 0));
  y = _mm_shuffle_ps(xy01, xy23, _MM_SHUFFLE(3, 2, 3, 2));
  z = _mm_shuffle_ps(z01, z23, _MM_SHUFFLE(1, 0, 1, 0));
}
MERISTEM_INLINE void transpose(F8 p0, F8 p1, F8 p2, F8 p3, F8 (&out)[3]) {
  transpose4(p0.low, p1.low, p2.low, p3.low, out[0].low, out[1].low, out[2].low);
  transpose4(p0.high, p1.high, p2.high, p3.high, out[0].high, out[1].high, out[2].high);
}
#endif

MERISTEM_INLINE float least(F8 a) {
  __m128 m = _mm_min_ps(lower(a), upper(a));
  m = _mm_min_ps(m, _mm_movehl_ps(m, m));
  return _mm_cvtss_f32(_mm_min_ss(m, _mm_shuffle_ps(m, m, 1)));
}
MERISTEM_INLINE float greatest(F8 a) {
  __m128 m = _mm_max_ps(lower(a), upper(a));
  m = _mm_max_ps(m, _mm_movehl_ps(m, m));
  return _mm_cvtss_f32(_mm_max_ss(m, _mm_shuffle_ps(m, m, 1)));
}

// Eight points, seen from the ray: it is at (0, 0), z is t.
struct Sheared {
  F8 x, y, z;
};

// Makes the longest axis of a ray the last.
alignas(16) constexpr std::uint8_t orders_by_axis[3][16] = {
    {4, 5, 6, 7, 8, 9, 10, 11, 0, 1, 2, 3, 12, 13, 14, 15},
    {8, 9, 10, 11, 0, 1, 2, 3, 4, 5, 6, 7, 12, 13, 14, 15},
    {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
};

// What does not change while a ray goes through trees.
struct RayLanes {
  RayLanes(const TreeRay& r, float t_from)
      : ray(r),
        order(load_order(orders_by_axis[r.axis])),
        shear_x(splat(r.shear_x)),
        shear_y(splat(r.shear_y)),
        shear_z(splat(r.shear_z)),
        t_min(splat(t_from)) {
    const __m128 turned = ordered(_mm_load_ps(r.origin.data()), order);
    origin[0] = lane<0>(turned);
    origin[1] = lane<1>(turned);
    origin[2] = lane<2>(turned);
  }

  // Of points 0 to 3 in the lower halves, 4 to 7 in the upper.
  MERISTEM_INLINE Sheared sheared(F8 p0, F8 p1, F8 p2, F8 p3) const {
    F8 p[3];
    transpose(ordered(p0, order), ordered(p1, order), ordered(p2, order), ordered(p3, order), p);
    const F8 along = sub(p[2], origin[2]);
    return {sub(sub(p[0], origin[0]), mul(shear_x, along)), sub(sub(p[1], origin[1]), mul(shear_y, along)),
            mul(shear_z, along)};
  }

  const TreeRay& ray;
  LaneOrder order;
  F8 origin[3];
  F8 shear_x, shear_y, shear_z;
  F8 t_min;
};

// Where vertices lie that are floats,
struct LoosePoints {
  MERISTEM_INLINE explicit LoosePoints(const PositionView& view) : data(static_cast<const float*>(view.data)) {}
  // Of two vertices, one in each half.
  MERISTEM_INLINE F8 pair(std::uint32_t a, std::uint32_t b) const {
    return join(_mm_loadu_ps(data + 3 * std::size_t(a)), _mm_loadu_ps(data + 3 * std::size_t(b)));
  }

  const float* data;
};

// and those on a lattice.
struct PackedPoints {
  MERISTEM_INLINE explicit PackedPoints(const PositionView& view)
      : data(static_cast<const std::uint16_t*>(view.data)), step(splat(view.step())) {
    const __m128 lanes = _mm_loadu_ps(view.lattice);
    origin = join(lanes, lanes);
  }
  MERISTEM_INLINE F8 pair(std::uint32_t a, std::uint32_t b) const {
    return add(mul(from_words(data + 3 * std::size_t(a), data + 3 * std::size_t(b)), step), origin);
  }

  const std::uint16_t* data;
  F8 origin, step;
};

// The corners of a block's triangles. Of a quad these are (00, 10, 01), lanes 0 to 3, and (11, 01, 10), lanes 4 to 7.
// Where there are fewer columns, rows or triangles, some appear twice, or have no area.
template <class Points>
MERISTEM_INLINE void load_corners(const TreeView& tree, std::uint32_t block, const RayLanes& ray, Sheared& a,
                                  Sheared& b, Sheared& c) {
  const Points points(tree.positions);
  const SurfaceTree::Node& node = tree.nodes[block / 8];
  const std::uint32_t first = node.first[block % 8], stride = node.stride[block % 8], shape = node.shape[block % 8];
  if (stride > 0) {
    const std::uint32_t r0 = first, r1 = r0 + stride, r2 = r0 + stride * (shape / 16), last = shape % 16;
    a = ray.sheared(points.pair(r0, r1 + 1), points.pair(r0 + 1, r1 + last), points.pair(r1, r2 + 1),
                    points.pair(r1 + 1, r2 + last));
    b = ray.sheared(points.pair(r0 + 1, r1), points.pair(r0 + last, r1 + 1), points.pair(r1 + 1, r2),
                    points.pair(r1 + last, r2 + 1));
    c = {swap_halves(b.x), swap_halves(b.y), swap_halves(b.z)};
    return;
  }
  const auto* const triangles = tree.triangles + first;
  const std::uint32_t last = shape - 1;
  const std::uint32_t* corners[8];
  for (std::uint32_t i = 0; i < 8; ++i) corners[i] = triangles[i < last ? i : last].data();
  Sheared* const out[3] = {&a, &b, &c};
  for (int k = 0; k < 3; ++k) {
    const auto pair = [&](int i) { return points.pair(corners[i][k], corners[i + 4][k]); };
    *out[k] = ray.sheared(pair(0), pair(1), pair(2), pair(3));
  }
}

// Woop et al. 2013: twice the signed areas of the triangles that rays make with the edges of triangles.
struct EdgeFunctions {
  MERISTEM_INLINE EdgeFunctions(const Sheared& a, const Sheared& b, const Sheared& c)
      : u(sub(mul(c.x, b.y), mul(c.y, b.x))),
        v(sub(mul(a.x, c.y), mul(a.y, c.x))),
        w(sub(mul(b.x, a.y), mul(b.y, a.x))),
        area(add(add(u, v), w)) {}

  // Where the ray's line goes through the triangle,
  MERISTEM_INLINE unsigned met() const {
    const F8 zero = splat(0);
    const unsigned inside = where_le(zero, min(min(u, v), w)) | where_le(max(max(u, v), w), zero);
    return inside == 0 ? 0 : inside & ~where_zero(area);
  }
  // and there
  MERISTEM_INLINE F8 t(const Sheared& a, const Sheared& b, const Sheared& c) const {
    return div(add(add(mul(u, a.z), mul(v, b.z)), mul(w, c.z)), area);
  }

  F8 u, v, w, area;
};

template <bool Any>
MERISTEM_INLINE bool meet_block(const TreeView& tree, std::uint32_t block, const RayLanes& ray, TreeHit& hit) {
  Sheared a, b, c;
  if (tree.positions.is_packed())
    load_corners<PackedPoints>(tree, block, ray, a, b, c);
  else
    load_corners<LoosePoints>(tree, block, ray, a, b, c);
  const EdgeFunctions e(a, b, c);
  unsigned met = e.met();
  if (met == 0) return false;
  const F8 t = e.t(a, b, c);
  met &= where_lt(ray.t_min, t) & where_le(t, splat(hit.t));
  if (met == 0) return false;
  if constexpr (Any) return true;
  alignas(32) float ts[8], vs[8], ws[8], areas[8];
  store(ts, t);
  int nearest = std::countr_zero(met);
  for (unsigned rest = met & (met - 1); rest; rest &= rest - 1) {
    const int i = std::countr_zero(rest);
    if (ts[i] < ts[nearest] || (ts[i] == ts[nearest] && wins_tie_in_block(tree, block, i, nearest))) nearest = i;
  }
  const std::uint32_t triangle = 8 * block + std::uint32_t(nearest);
  if (ts[nearest] == hit.t && hit.triangle != TreeHit::none && !wins_tie(tree, triangle, hit.triangle)) return false;
  store(vs, e.v);
  store(ws, e.w);
  store(areas, e.area);
  hit = {ts[nearest], triangle, vs[nearest] / areas[nearest], ws[nearest] / areas[nearest]};
  return true;
}

// Where a ray enters and leaves the children of a node.
struct Children {
  F8 entries, exits;

  // Those that it may meet.
  MERISTEM_INLINE unsigned of(const SurfaceTree::Node& node) const {
    return where_le(entries, exits) & ((1u << node.children) - 1);
  }
};

MERISTEM_INLINE Children meet_children(const SurfaceTree::Node& node, const TreeRay& ray, F8 t_min, float t) {
  const __m128 origin = _mm_load_ps(ray.origin.data()), reciprocal = _mm_load_ps(ray.reciprocal.data()),
               slack = _mm_load_ps(ray.slack.data());
  const __m128 distance = _mm_sub_ps(_mm_loadu_ps(node.origin.data()), origin);
  int exponents;  // and what stands behind them
  __builtin_memcpy(&exponents, reinterpret_cast<const char*>(&node) + sizeof node.origin, sizeof exponents);
  const __m128 step = _mm_castsi128_ps(_mm_slli_epi32(_mm_cvtepu8_epi32(_mm_cvtsi32_si128(exponents)), 23));
  const __m128 magnitude = _mm_add_ps(_mm_andnot_ps(_mm_set1_ps(-0.f), distance), _mm_mul_ps(step, _mm_set1_ps(256)));
  const __m128 base = _mm_mul_ps(distance, reciprocal), error = _mm_mul_ps(magnitude, slack);
  const __m128 enter = _mm_sub_ps(base, error), leave = _mm_add_ps(base, error), scale = _mm_mul_ps(step, reciprocal);
  const auto near_plane = [&](int axis) { return from_bytes(node.bounds[axis][ray.near_side[axis]]); };
  const auto far_plane = [&](int axis) { return from_bytes(node.bounds[axis][1 - ray.near_side[axis]]); };
  const F8 scale_x = lane<0>(scale), scale_y = lane<1>(scale), scale_z = lane<2>(scale);
  const F8 entries = max(
      max(mul_add_loose(near_plane(0), scale_x, lane<0>(enter)), mul_add_loose(near_plane(1), scale_y, lane<1>(enter))),
      max(mul_add_loose(near_plane(2), scale_z, lane<2>(enter)), t_min));
  const F8 exits = min(
      min(mul_add_loose(far_plane(0), scale_x, lane<0>(leave)), mul_add_loose(far_plane(1), scale_y, lane<1>(leave))),
      min(mul_add_loose(far_plane(2), scale_z, lane<2>(leave)), splat(t)));
  return {entries, exits};
}

// A child and where the ray enters it.
struct Entered {
  std::uint32_t child;
  float t;
};

// What is still to be met, the nearest last.
struct Waiting {
  Entered stack[SurfaceTree::most_waiting];
  std::size_t count = 0;

  // The next that may lie before t.
  MERISTEM_INLINE bool take(float t, std::uint32_t& child) {
    do {
      if (count == 0) return false;
      --count;
    } while (stack[count].t > t);
    child = stack[count].child;
    return true;
  }
};

// A child of a node that is no node itself.
constexpr std::uint32_t is_end = SurfaceTree::is_block;

MERISTEM_INLINE void prefetch_node(const SurfaceTree::Node& node) {
  const char* const lines = reinterpret_cast<const char*>(&node);
  _mm_prefetch(lines, _MM_HINT_T0);
  _mm_prefetch(lines + 64, _MM_HINT_T0);
}

// A node, or an end by 8 * node + place.
MERISTEM_INLINE std::uint32_t child_at(const SurfaceTree::Node& node, std::uint32_t index, std::uint32_t place) {
  return node.shape[place] == 0 ? node.first[place] : (8 * index + place) | is_end;
}

// Nodes of trees: their ends are blocks.
struct OfTree {
  const TreeView& tree;

  const SurfaceTree::Node& node(std::uint32_t index) const { return tree.nodes[index]; }
  // What a ray meets next is asked for while it is with others.
  MERISTEM_INLINE void prefetch(const SurfaceTree::Node& node, std::uint32_t place) const {
    const std::uint32_t first = node.first[place], stride = node.stride[place];
    if (stride > 0) {
      const char* const row = tree.positions.address(first);
      const std::size_t row_bytes = stride * tree.positions.bytes_a_vertex();
      _mm_prefetch(row, _MM_HINT_T0);
      _mm_prefetch(row + row_bytes, _MM_HINT_T0);
      _mm_prefetch(row + 2 * row_bytes, _MM_HINT_T0);
    } else if (node.shape[place] == 0) {
      prefetch_node(tree.nodes[first]);
    }
  }
};

// Nodes of braids: their ends are strands and others.
struct OfBraid {
  const Braid::View& braid;

  const SurfaceTree::Node& node(std::uint32_t index) const { return braid.nodes[index]; }
  bool is_strand(std::uint32_t end) const { return node(end / 8).shape[end % 8] == Braid::is_strand; }
  const Braid::Strand& strand(std::uint32_t end) const { return braid.strands[node(end / 8).first[end % 8]]; }
  std::uint32_t other(std::uint32_t end) const { return node(end / 8).first[end % 8]; }
  MERISTEM_INLINE void prefetch(const SurfaceTree::Node& node, std::uint32_t place) const {
    if (node.shape[place] == Braid::is_node)
      prefetch_node(braid.nodes[node.first[place]]);
    else if (node.shape[place] == Braid::is_strand)
      _mm_prefetch(reinterpret_cast<const char*>(braid.strands + node.first[place]), _MM_HINT_T0);
  }
};

// Goes on from a node to the nearest of its children that the ray may meet up to t; the others wait. Any: to the first
// of them. False: it meets none.
template <bool Any, class Of>
MERISTEM_INLINE bool descend(const Of& of, std::uint32_t& index, const RayLanes& ray, float t, Waiting& waiting) {
  const SurfaceTree::Node& node = of.node(index);
  const Children children = meet_children(node, ray.ray, ray.t_min, t);
  unsigned met = children.of(node);
  if (met == 0) return false;
  const auto place = std::uint32_t(std::countr_zero(met));
  met &= met - 1;
  if (met == 0) {
    index = child_at(node, index, place);
    return true;
  }
  alignas(32) float ts[8];
  store(ts, children.entries);
  for (unsigned rest = met; rest; rest &= rest - 1) of.prefetch(node, std::uint32_t(std::countr_zero(rest)));
  Entered nearest{child_at(node, index, place), ts[place]};
  const std::size_t first = waiting.count;
  for (; met; met &= met - 1) {
    const auto next = std::uint32_t(std::countr_zero(met));
    Entered farther{child_at(node, index, next), ts[next]};
    std::size_t at = waiting.count++;
    if constexpr (!Any) {
      if (farther.t < nearest.t) std::swap(farther, nearest);
      for (; at > first && waiting.stack[at - 1].t < farther.t; --at) waiting.stack[at] = waiting.stack[at - 1];
    }
    waiting.stack[at] = farther;
  }
  index = nearest.child;
  return true;
}

// From a node or block of the tree on.
template <bool Any>
bool trace(const TreeView& tree, std::uint32_t start, const RayLanes& ray, TreeHit& hit) {
  Waiting waiting;
  bool found = false;
  for (std::uint32_t child = start;;) {
    if (!(child & is_end)) {
      if (descend<Any>(OfTree{tree}, child, ray, hit.t, waiting)) continue;
    } else if (meet_block<Any>(tree, child & ~is_end, ray, hit)) {
      if constexpr (Any) return true;
      found = true;
    }
    if (!waiting.take(hit.t, child)) return found;
  }
}

template <bool Any>
bool trace(const Braid::View& braid, const RayLanes& ray, BraidVisitor& visitor) {
  Waiting waiting;
  for (std::uint32_t child = 0;;) {
    if (!(child & is_end)) {
      if (descend<Any>(OfBraid{braid}, child, ray, visitor.t_max, waiting)) continue;
    } else if (const std::uint32_t end = child & ~is_end; OfBraid{braid}.is_strand(end)) {
      const Braid::Strand& strand = OfBraid{braid}.strand(end);
      TreeHit hit{visitor.t_max};
      if (trace<Any>({strand.nodes, strand.triangles, strand.positions}, strand.start, ray, hit)) {
        if constexpr (Any) return true;
        visitor.met(strand.owner, hit);
      }
    } else {
      visitor.enter(OfBraid{braid}.other(end));
      if constexpr (Any)
        if (visitor.t_max < 0) return true;
    }
    if (!waiting.take(visitor.t_max, child)) return false;
  }
}

bool intersect(const TreeView& tree, const TreeRay& ray, float t_min, TreeHit& hit) {
  return trace<false>(tree, 0, RayLanes(ray, t_min), hit);
}

bool occluded(const TreeView& tree, const TreeRay& ray, float t_min, float t_max) {
  TreeHit hit{t_max};
  return trace<true>(tree, 0, RayLanes(ray, t_min), hit);
}

void intersect_braid(const Braid::View& braid, const TreeRay& ray, float t_min, BraidVisitor& visitor) {
  trace<false>(braid, RayLanes(ray, t_min), visitor);
}

bool occlude_braid(const Braid::View& braid, const TreeRay& ray, float t_min, BraidVisitor& visitor) {
  return trace<true>(braid, RayLanes(ray, t_min), visitor);
}

}  // namespace
}  // namespace meristem
