// Lanes: the few vector operations that kernels are written in, those of the expression language and others, over 4
// lanes (SSE4.2), 8 lanes (AVX2 and FMA) or 16 lanes (AVX-512). Every operation acts on each lane by itself and is
// exact or correctly rounded, and products and sums are fused only where fused() says so, so a lane gets the same bits
// with any width and at any position.
//
// Only for files named *kernels_*.cpp, which define MERISTEM_LANES first; everything is local to them.
#pragma once

#include <cstdint>
#include <immintrin.h>

#ifndef MERISTEM_LANES
#error "lanes.h is only for the kernels"
#endif
// After the includes: inline functions of other headers must stay at the baseline.
#if MERISTEM_LANES == 16
#pragma GCC target("avx2,fma,avx512f,avx512dq,avx512bw,avx512vl")
#elif MERISTEM_LANES == 8
#pragma GCC target("avx2,fma")
#endif
#pragma GCC diagnostic ignored "-Wunused-function"
#if MERISTEM_LANES == \
    16  // GCC's own header says `__Y = __Y` for operands that a full mask makes unused: GCC bug 105593
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

namespace meristem {
namespace {

constexpr int width = MERISTEM_LANES;

typedef float F __attribute__((vector_size(4 * width)));
typedef std::int32_t I __attribute__((vector_size(4 * width)));
typedef std::uint32_t U __attribute__((vector_size(4 * width)));
typedef double D __attribute__((vector_size(4 * width)));  // half as many lanes
typedef std::int64_t L __attribute__((vector_size(4 * width)));
typedef std::uint64_t UL __attribute__((vector_size(4 * width)));
typedef F LooseF __attribute__((aligned(4), may_alias));
typedef D LooseD __attribute__((aligned(8), may_alias));

#define MERISTEM_INLINE [[gnu::always_inline]] inline

MERISTEM_INLINE F load(const float* p) { return *reinterpret_cast<const LooseF*>(p); }
MERISTEM_INLINE void store(float* p, F v) { *reinterpret_cast<LooseF*>(p) = v; }
MERISTEM_INLINE D load(const double* p) { return *reinterpret_cast<const LooseD*>(p); }
MERISTEM_INLINE void store(double* p, D v) { *reinterpret_cast<LooseD*>(p) = v; }
MERISTEM_INLINE F splat(float v) { return F{} + v; }
MERISTEM_INLINE I splat(std::int32_t v) { return I{} + v; }
MERISTEM_INLINE D splat(double v) { return D{} + v; }

// Like the instructions, min and max give b if either is NaN. blend takes b where the top bit of mask is set. truncate
// gives INT_MIN where the value does not fit. floor(a, whole) gives truncate(floor(a)) too.
#if MERISTEM_LANES == 16
constexpr int down = _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC, up = _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC,
              to_zero = _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC;
MERISTEM_INLINE F min(F a, F b) { return _mm512_min_ps(a, b); }
MERISTEM_INLINE F max(F a, F b) { return _mm512_max_ps(a, b); }
MERISTEM_INLINE D min(D a, D b) { return _mm512_min_pd(a, b); }
MERISTEM_INLINE D max(D a, D b) { return _mm512_max_pd(a, b); }
MERISTEM_INLINE F floor(F a) { return _mm512_roundscale_ps(a, down); }
MERISTEM_INLINE F ceil(F a) { return _mm512_roundscale_ps(a, up); }
MERISTEM_INLINE F trunc(F a) { return _mm512_roundscale_ps(a, to_zero); }
MERISTEM_INLINE D floor(D a) { return _mm512_roundscale_pd(a, down); }
MERISTEM_INLINE D trunc(D a) { return _mm512_roundscale_pd(a, to_zero); }
MERISTEM_INLINE F sqrt(F a) { return _mm512_sqrt_ps(a); }
MERISTEM_INLINE D sqrt(D a) { return _mm512_sqrt_pd(a); }
MERISTEM_INLINE I truncate(F a) { return I(_mm512_cvttps_epi32(a)); }
MERISTEM_INLINE U exclusive_or(U a, U b, U c) {
  return U(_mm512_ternarylogic_epi32(__m512i(a), __m512i(b), __m512i(c), 0x96));
}
MERISTEM_INLINE F fused(F a, F b, F c) { return _mm512_fmadd_ps(a, b, c); }
MERISTEM_INLINE F to_float(I a) { return _mm512_cvtepi32_ps(__m512i(a)); }
MERISTEM_INLINE F floor(F a, I& whole) { return to_float(whole = I(_mm512_cvt_roundps_epi32(a, down))); }
MERISTEM_INLINE F blend(F a, F b, I mask) { return _mm512_mask_blend_ps(_mm512_movepi32_mask(__m512i(mask)), a, b); }
MERISTEM_INLINE D blend(D a, D b, L mask) { return _mm512_mask_blend_pd(_mm512_movepi64_mask(__m512i(mask)), a, b); }
MERISTEM_INLINE D lower_half(F a) { return _mm512_cvtps_pd(_mm512_castps512_ps256(a)); }
MERISTEM_INLINE D upper_half(F a) { return _mm512_cvtps_pd(_mm512_extractf32x8_ps(a, 1)); }
MERISTEM_INLINE F join(D lower, D upper) {
  return _mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(lower)), _mm512_cvtpd_ps(upper), 1);
}
#elif MERISTEM_LANES == 8
MERISTEM_INLINE F min(F a, F b) { return _mm256_min_ps(a, b); }
MERISTEM_INLINE F max(F a, F b) { return _mm256_max_ps(a, b); }
MERISTEM_INLINE D min(D a, D b) { return _mm256_min_pd(a, b); }
MERISTEM_INLINE D max(D a, D b) { return _mm256_max_pd(a, b); }
MERISTEM_INLINE F floor(F a) { return _mm256_floor_ps(a); }
MERISTEM_INLINE F ceil(F a) { return _mm256_ceil_ps(a); }
MERISTEM_INLINE F trunc(F a) { return _mm256_round_ps(a, _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC); }
MERISTEM_INLINE D floor(D a) { return _mm256_floor_pd(a); }
MERISTEM_INLINE D trunc(D a) { return _mm256_round_pd(a, _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC); }
MERISTEM_INLINE F sqrt(F a) { return _mm256_sqrt_ps(a); }
MERISTEM_INLINE D sqrt(D a) { return _mm256_sqrt_pd(a); }
MERISTEM_INLINE I truncate(F a) { return I(_mm256_cvttps_epi32(a)); }
MERISTEM_INLINE F fused(F a, F b, F c) { return _mm256_fmadd_ps(a, b, c); }
MERISTEM_INLINE F to_float(I a) { return _mm256_cvtepi32_ps(__m256i(a)); }
MERISTEM_INLINE F blend(F a, F b, I mask) { return _mm256_blendv_ps(a, b, __m256(mask)); }
MERISTEM_INLINE D blend(D a, D b, L mask) { return _mm256_blendv_pd(a, b, __m256d(mask)); }
MERISTEM_INLINE D lower_half(F a) { return _mm256_cvtps_pd(_mm256_castps256_ps128(a)); }
MERISTEM_INLINE D upper_half(F a) { return _mm256_cvtps_pd(_mm256_extractf128_ps(a, 1)); }
MERISTEM_INLINE F join(D lower, D upper) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps(lower)), _mm256_cvtpd_ps(upper), 1);
}
#else
MERISTEM_INLINE F min(F a, F b) { return _mm_min_ps(a, b); }
MERISTEM_INLINE F max(F a, F b) { return _mm_max_ps(a, b); }
MERISTEM_INLINE D min(D a, D b) { return _mm_min_pd(a, b); }
MERISTEM_INLINE D max(D a, D b) { return _mm_max_pd(a, b); }
MERISTEM_INLINE F floor(F a) { return _mm_floor_ps(a); }
MERISTEM_INLINE F ceil(F a) { return _mm_ceil_ps(a); }
MERISTEM_INLINE F trunc(F a) { return _mm_round_ps(a, _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC); }
MERISTEM_INLINE D floor(D a) { return _mm_floor_pd(a); }
MERISTEM_INLINE D trunc(D a) { return _mm_round_pd(a, _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC); }
MERISTEM_INLINE F sqrt(F a) { return _mm_sqrt_ps(a); }
MERISTEM_INLINE D sqrt(D a) { return _mm_sqrt_pd(a); }
MERISTEM_INLINE I truncate(F a) { return I(_mm_cvttps_epi32(a)); }
MERISTEM_INLINE F to_float(I a) { return _mm_cvtepi32_ps(__m128i(a)); }
MERISTEM_INLINE F blend(F a, F b, I mask) { return _mm_blendv_ps(a, b, __m128(mask)); }
MERISTEM_INLINE D blend(D a, D b, L mask) { return _mm_blendv_pd(a, b, __m128d(mask)); }
MERISTEM_INLINE D lower_half(F a) { return _mm_cvtps_pd(a); }
MERISTEM_INLINE D upper_half(F a) { return _mm_cvtps_pd(_mm_movehl_ps(a, a)); }
MERISTEM_INLINE F join(D lower, D upper) { return _mm_movelh_ps(_mm_cvtpd_ps(lower), _mm_cvtpd_ps(upper)); }
#endif

#if MERISTEM_LANES != 16
MERISTEM_INLINE F floor(F a, I& whole) {
  a = floor(a);
  whole = truncate(a);
  return a;
}
MERISTEM_INLINE U exclusive_or(U a, U b, U c) { return a ^ b ^ c; }
#endif

// fused: a * b + c, rounded once. The baseline has no such instruction: there the product is exact in double, and the
// sum is rounded to odd (Boldo and Melquiond 2008, "Emulation of FMA and correctly rounded sums"), so that rounding it
// again, to float, is as if it were the first time.
#if MERISTEM_LANES == 4
MERISTEM_INLINE D add_to_odd(D a, D b) {
  const D sum = a + b, back = sum - a;
  const D error = (a - (sum - back)) + (b - back);
  const L inexact = L(error != 0.0) & ((L(sum) & 1) - 1);  // and even: an odd one is right already
  const L away = L((error > 0.0) == (sum > 0.0)) | 1;      // -1 where the true sum is the larger one, else 1
  return D(L(sum) - (inexact & away));
}
MERISTEM_INLINE F fused(F a, F b, F c) {
  return join(add_to_odd(lower_half(a) * lower_half(b), lower_half(c)),
              add_to_odd(upper_half(a) * upper_half(b), upper_half(c)));
}
#endif

MERISTEM_INLINE F clamp(F a, F lower, F upper) { return min(max(a, lower), upper); }
MERISTEM_INLINE D clamp(D a, D lower, D upper) { return min(max(a, lower), upper); }
// Clamps to +-bound.
#if MERISTEM_LANES == 16
constexpr int smaller_magnitude_with_sign_of_first = 2;
MERISTEM_INLINE F limit(F a, float bound) {
  return _mm512_range_ps(a, splat(bound), smaller_magnitude_with_sign_of_first);
}
MERISTEM_INLINE D limit(D a, double bound) {
  return _mm512_range_pd(a, splat(bound), smaller_magnitude_with_sign_of_first);
}
#else
MERISTEM_INLINE F limit(F a, float bound) { return clamp(a, splat(-bound), splat(bound)); }
MERISTEM_INLINE D limit(D a, double bound) { return clamp(a, splat(-bound), splat(bound)); }
#endif
// Results are finite: what would overflow becomes the largest number of its sign.
constexpr float largest = 3.40282347e38f;
MERISTEM_INLINE F finite(F a) { return limit(a, largest); }
MERISTEM_INLINE D finite(D a) { return limit(a, double(largest)); }
MERISTEM_INLINE F abs(F a) { return F(I(a) & splat(INT32_MAX)); }
MERISTEM_INLINE D abs(D a) { return D(L(a) & (L{} + INT64_MAX)); }
MERISTEM_INLINE F copy_sign(F magnitude, F sign) {
  return F((I(magnitude) & splat(INT32_MAX)) | (I(sign) & splat(INT32_MIN)));
}
MERISTEM_INLINE D copy_sign(D magnitude, D sign) {
  return D((L(magnitude) & (L{} + INT64_MAX)) | (L(sign) & (L{} + INT64_MIN)));
}
MERISTEM_INLINE F one_where(I mask) { return F(I(splat(1.0f)) & mask); }

}  // namespace
}  // namespace meristem
