// Elementary functions over lanes, computed in double by argument reduction and power series and rounded to float once:
// the error is below 0.51 ulp of the float result wherever the result is not clamped (tests/geometry/fields/values_test
// measures it). Total: arguments outside of a function's domain are clamped to it (docs/expressions.md).
// Only for files that define MERISTEM_LANES.
#pragma once

#include "geometry/fields/lanes.h"

namespace meristem {
namespace {

constexpr double half_pi = 1.57079632679489661923;
constexpr double ln2 = 0.69314718055994530942;

// Applies f to the lanes as doubles; the result is made finite.
template <class Function>
MERISTEM_INLINE F in_double(Function f, F a) {
  return join(finite(f(lower_half(a))), finite(f(upper_half(a))));
}
template <class Function>
MERISTEM_INLINE F in_double(Function f, F a, F b) {
  return join(finite(f(lower_half(a), lower_half(b))), finite(f(upper_half(a), upper_half(b))));
}

// The nearest integer of a (|a| < 2^51), and the same in the low bits of `bits`.
MERISTEM_INLINE D nearest(D a, L& bits) {
  const D shifted = a + 0x1.8p52;
  bits = L(shifted);
  return shifted - 0x1.8p52;
}

// a = quarter * pi/2 + result, |result| <= pi/4 (1 + 2^-20). Cody and Waite with parts of 22 bits: products are exact.
MERISTEM_INLINE D reduce_angle(D a, L& quarter) {
  a = limit(a, 0x1p30);
  const D k = nearest(a * (1 / half_pi), quarter);
  return ((a - k * 0x1.921fbp+0) - k * 0x1.5110bp-22) - k * 0x1.18469898cc517p-44;
}
// a + b s + c s^2 + ... in pairs, which halves the chain of dependent operations of Horner's scheme.
MERISTEM_INLINE D series(D s, double a, double b, double c, double d, double e, double f) {
  const D q = s * s;
  return (a + b * s) + q * ((c + d * s) + q * (e + f * s));
}
MERISTEM_INLINE D sin_series(D r) {
  return r +
         r * (r * r) * series(r * r, -1.0 / 6, 1.0 / 120, -1.0 / 5040, 1.0 / 362880, -1.0 / 39916800, 1.0 / 6227020800);
}
MERISTEM_INLINE D cos_series(D r) {
  return 1.0 + (r * r) * series(r * r, -0.5, 1.0 / 24, -1.0 / 720, 1.0 / 40320, -1.0 / 3628800, 1.0 / 479001600);
}
// sin(a + half_turns * pi/2), half_turns being 0 or 1: a = n pi + r with |r| <= pi/2 (1 + 2^-20), n a whole number less
// half_turns / 2. One polynomial serves both: through the Chebyshev nodes of r^2, within 2^-33 of sin(r).
MERISTEM_INLINE D sine(D a, int half_turns) {
  a = limit(a, 0x1p30);
  L half;
  const D turns = a * (0.5 / half_pi);
  const D n = half_turns ? nearest(turns + 0.5, half) - 0.5 : nearest(turns, half);
  const D r = ((a - n * 0x1.921fbp+1) - n * 0x1.5110bp-21) - n * 0x1.18469898cc517p-43;
  const D s = r * r, q = s * s;
  const D value = r + r * s *
                          ((-0x1.555555546051dp-3 + 0x1.11110fdaae539p-7 * s) +
                           q * ((-0x1.a01905b986dd9p-13 + 0x1.7196915c988efp-19 * s) - q * 0x1.9db1c811f544cp-26));
  return D(L(value) ^ (half << 63));
}
MERISTEM_INLINE D tangent(D a) {
  L quarter;
  const D r = reduce_angle(a, quarter);
  const D s = sin_series(r), c = cos_series(r);
  const L odd = quarter << 63;
  return blend(s, -c, odd) / blend(c, s, odd);
}

MERISTEM_INLINE D exponential(D a) {
  a = limit(a, 200);
  L k;
  const D n = nearest(a * (1 / ln2), k);
  const D r = (a - n * 0x1.62e42fef8p-1) - n * 0x1.1cf79abc9e3b4p-36;
  const D q = r * r, q3 = q * q * q;
  const D value = series(r, 1, 1, 1.0 / 2, 1.0 / 6, 1.0 / 24, 1.0 / 120) +
                  q3 * series(r, 1.0 / 720, 1.0 / 5040, 1.0 / 40320, 1.0 / 362880, 1.0 / 3628800, 1.0 / 39916800);
  return D(L(value) + (k << 52));
}

// The natural logarithm of max(a, 2^-126).
MERISTEM_INLINE D logarithm(D a) {
  a = max(a, splat(0x1p-126));
  // a = 2^k m with m in [sqrt(1/2), sqrt(2)); the bias keeps k + 1024 positive for the logical shift
  constexpr std::int64_t root_half = 0x3fe6a09e667f3bcd;
  const L above = L(a) - (L{} + root_half);
  const D k = D(L(UL(above + (L{} + (std::int64_t(1024) << 52))) >> 52) | (L{} + 0x4330000000000000)) - (0x1p52 + 1024);
  const D m = D((above & (L{} + 0xfffffffffffff)) + root_half);
  const D s = (m - 1.0) / (m + 1.0), q = s * s;
  const D q3 = q * q * q;
  const D tail =
      series(q, 1.0 / 3, 1.0 / 5, 1.0 / 7, 1.0 / 9, 1.0 / 11, 1.0 / 13) + q3 * q3 * (1.0 / 15 + q * (1.0 / 17));
  return k * ln2 + (2.0 * s + 2.0 * s * q * tail);
}

// x^y; 0 for a negative x with a broken y, and for 0 with a negative y.
MERISTEM_INLINE D power(D x, D y) {
  const D magnitude = exponential(y * logarithm(abs(x)));
  const D half = y * 0.5;
  const L is_broken = L(floor(y) != y), is_odd = L(floor(half) != half) & ~is_broken;
  const L negative = L(x < 0.0), zero = L(x == 0.0);
  D value = D(L(magnitude) ^ (negative & is_odd & (L{} + INT64_MIN)));
  value = D(L(value) & ~(negative & is_broken) & ~zero);
  return blend(value, splat(1.0), L(y == 0.0));
}

MERISTEM_INLINE D arc_tangent(D a) {
  constexpr double root3 = 1.73205080756887729353, twelfth = 0.26794919243112270647;  // tan(pi / 12)
  const D m = abs(a);
  const L inverted = L(m > 1.0);
  const D b = blend(m, 1.0 / m, inverted);
  const L turned = L(b > twelfth);
  const D c = blend(b, (root3 * b - 1.0) / (root3 + b), turned);
  const D s = c * c;
  D value =
      c +
      c * s *
          (-1.0 / 3 +
           s * (1.0 / 5 +
                s * (-1.0 / 7 + s * (1.0 / 9 + s * (-1.0 / 11 + s * (1.0 / 13 + s * (-1.0 / 15 + s * (1.0 / 17))))))));
  value += D(turned & L(splat(half_pi / 3)));
  return copy_sign(blend(value, half_pi - value, inverted), a);
}
MERISTEM_INLINE D arc_sine(D a) {
  a = limit(a, 1);
  return arc_tangent(a / sqrt((1.0 - a) * (1.0 + a)));  // a quotient of infinity is pi/2
}
// The angle of (x, y); 0 for the zero vector.
MERISTEM_INLINE D arc_tangent(D y, D x) {
  const D angle = arc_tangent(abs(y) / abs(x));
  const D value = copy_sign(blend(angle, 2 * half_pi - angle, L(x < 0.0)), y);
  return D(L(value) & ~(L(x == 0.0) & L(y == 0.0)));
}

MERISTEM_INLINE D hyperbolic_sine(D a) {
  const D e = exponential(a);
  return blend((e - 1.0 / e) * 0.5, a + a * a * a * (1.0 / 6), L(abs(a) < 1e-2));
}
MERISTEM_INLINE D hyperbolic_cosine(D a) {
  const D e = exponential(a);
  return (e + 1.0 / e) * 0.5;
}
MERISTEM_INLINE D hyperbolic_tangent(D a) {
  const D e = exponential(2.0 * limit(a, 50));
  const D s = a * a;
  return blend((e - 1.0) / (e + 1.0), a * (1.0 - s * (1.0 / 3 - s * (2.0 / 15))), L(abs(a) < 1e-2));
}
// The series of the inverse functions are within 2^-54 of them.
MERISTEM_INLINE D inverse_hyperbolic_sine(D a) {
  const D m = abs(a), s = a * a;
  const D value = copy_sign(logarithm(m + sqrt(s + 1.0)), a);
  return blend(value, a * (1.0 - s * (1.0 / 6 - s * (3.0 / 40 - s * (15.0 / 336)))), L(m < 1e-2));
}
MERISTEM_INLINE D inverse_hyperbolic_cosine(D a) {
  a = max(a, splat(1.0));
  return logarithm(a + sqrt((a - 1.0) * (a + 1.0)));
}
MERISTEM_INLINE D inverse_hyperbolic_tangent(D a) {
  a = limit(a, 1 - 0x1p-24);
  const D s = a * a;
  return blend(logarithm((1.0 + a) / (1.0 - a)) * 0.5, a * (1.0 + s * (1.0 / 3 + s * (1.0 / 5 + s * (1.0 / 7)))),
               L(abs(a) < 1e-2));
}
MERISTEM_INLINE D cube_root(D a) {
  const D value = copy_sign(exponential(logarithm(abs(a)) * (1.0 / 3)), a);
  return D(L(value) & ~L(a == 0.0));
}

// x - floor(x / y) y: in [0, y) for positive y; 0 if y is 0.
MERISTEM_INLINE D modulo(D x, D y) {
  const D zero = splat(0.0);
  const D r = clamp(x - floor(x / y) * y, min(y, zero), max(y, zero));
  return D(L(r) & ~L(y == 0.0));
}
// The remainder with the sign of x, as C's fmod; 0 if y is 0.
MERISTEM_INLINE D remainder(D x, D y) {
  const D m = abs(x), d = abs(y);
  const D r = clamp(m - trunc(m / d) * d, splat(0.0), d);
  return D(L(copy_sign(r, x)) & ~L(y == 0.0));
}

}  // namespace
}  // namespace meristem
