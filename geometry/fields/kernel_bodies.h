// The kernels, compiled once by each of the kernels_*.cpp files.
#pragma once

#include "geometry/fields/kernels.h"
#include "geometry/fields/math_lanes.h"
#include "geometry/fields/noise4_lanes.h"
#include "geometry/fields/noise_lanes.h"

namespace meristem {
namespace {

MERISTEM_INLINE F at(const Operand& operand, int lane) { return load(operand.data + (lane & operand.step_mask)); }
MERISTEM_INLINE Point point_at(const Operand* operands, int lane) {
  return {at(operands[0], lane), at(operands[1], lane), at(operands[2], lane)};
}
template <class Place>
MERISTEM_INLINE Place place_at(const Operand* operands, int lane) {
  if constexpr (Place::dimensions == 3)
    return point_at(operands, lane);
  else
    return {point_at(operands, lane), at(operands[3], lane)};
}
MERISTEM_INLINE void put(const std::array<float*, 3>& out, int lane, F value) { store(out[0] + lane, value); }
MERISTEM_INLINE void put(const std::array<float*, 3>& out, int lane, Point p) {
  store(out[0] + lane, p.x);
  store(out[1] + lane, p.y);
  store(out[2] + lane, p.z);
}

MERISTEM_INLINE F absolute(F a) { return abs(a); }
MERISTEM_INLINE Point absolute(Point p) { return {abs(p.x), abs(p.y), abs(p.z)}; }
MERISTEM_INLINE void add_scaled(F& sum, F a, F s) { sum = fused(a, s, sum); }
MERISTEM_INLINE void add_scaled(Point& sum, Point p, F s) {
  add_scaled(sum.x, p.x, s);
  add_scaled(sum.y, p.y, s);
  add_scaled(sum.z, p.z, s);
}

// The loops. `body` gives the value of the lanes that start at `lane`, from the operands. Of a fixed number of operands
// it gets copies of its own, which stay in registers: those of the call might be overwritten by the results, for all
// the compiler knows.
template <class Body>
MERISTEM_INLINE void for_lanes(const KernelCall& c, int lanes, Body body) {
  const std::array<float*, 3> out = c.out;
  for (int lane = 0; lane < lanes; lane += width) put(out, lane, body(lane));
}
template <int Count, class Body>
MERISTEM_INLINE void for_operands(const KernelCall& c, int lanes, Body body) {
  Operand operands[Count];
  for (int k = 0; k < Count; ++k) operands[k] = c.operands[k];
  for_lanes(
      c, lanes, [&](int i) __attribute__((always_inline)) { return body(operands, i); });
}
template <class Function>
MERISTEM_INLINE void unary(const KernelCall& c, int lanes, Function f) {
  for_operands<1>(
      c, lanes, [&](const Operand* a, int i) __attribute__((always_inline)) { return f(at(a[0], i)); });
}
template <class Function>
MERISTEM_INLINE void binary(const KernelCall& c, int lanes, Function f) {
  for_operands<2>(
      c, lanes, [&](const Operand* a, int i) __attribute__((always_inline)) { return f(at(a[0], i), at(a[1], i)); });
}
template <class Function>
MERISTEM_INLINE void ternary(const KernelCall& c, int lanes, Function f) {
  for_operands<3>(
      c, lanes, [&](const Operand* a, int i) __attribute__((always_inline)) {
        return f(at(a[0], i), at(a[1], i), at(a[2], i));
      });
}

#define UNARY(name, value)                                                       \
  void name(const KernelCall& c, int lanes) {                                    \
    unary(                                                                       \
        c, lanes, [&](F a) __attribute__((always_inline))->F { return value; }); \
  }
#define UNARY_DOUBLE(name, value)                                               \
  void name(const KernelCall& c, int lanes) {                                   \
    unary(                                                                      \
        c, lanes, [&](F f) __attribute__((always_inline))->F {                  \
          return in_double(                                                     \
              [&](D a) __attribute__((always_inline))->D { return value; }, f); \
        });                                                                     \
  }
#define BINARY(name, value)                                                           \
  void name(const KernelCall& c, int lanes) {                                         \
    binary(                                                                           \
        c, lanes, [&](F a, F b) __attribute__((always_inline))->F { return value; }); \
  }
#define BINARY_DOUBLE(name, value)                                                      \
  void name(const KernelCall& c, int lanes) {                                           \
    binary(                                                                             \
        c, lanes, [&](F f, F g) __attribute__((always_inline))->F {                     \
          return in_double(                                                             \
              [&](D a, D b) __attribute__((always_inline))->D { return value; }, f, g); \
        });                                                                             \
  }

namespace kernel {

UNARY(Not, one_where(I(a == 0.0f)))
UNARY(Abs, abs(a))
UNARY(Sign, one_where(I(a > 0.0f)) - one_where(I(a < 0.0f)))
UNARY(Floor, floor(a))
UNARY(Ceil, ceil(a))
UNARY(Round, floor(a + 0.5f))
UNARY(Trunc, trunc(a))
UNARY(Sqrt, sqrt(max(a, splat(0.0f))))
UNARY_DOUBLE(Cbrt, cube_root(a))
UNARY_DOUBLE(Exp, exponential(a))
UNARY_DOUBLE(Log, logarithm(a))
UNARY_DOUBLE(Log10, logarithm(a) * 0.43429448190325182765)
UNARY_DOUBLE(Sin, sine(a, 0))
UNARY_DOUBLE(Cos, sine(a, 1))
UNARY_DOUBLE(Tan, tangent(a))
UNARY_DOUBLE(Asin, arc_sine(a))
UNARY_DOUBLE(Acos, half_pi - arc_sine(a))
UNARY_DOUBLE(Atan, arc_tangent(a))
UNARY_DOUBLE(Sinh, hyperbolic_sine(a))
UNARY_DOUBLE(Cosh, hyperbolic_cosine(a))
UNARY_DOUBLE(Tanh, hyperbolic_tangent(a))
UNARY_DOUBLE(Asinh, inverse_hyperbolic_sine(a))
UNARY_DOUBLE(Acosh, inverse_hyperbolic_cosine(a))
UNARY_DOUBLE(Atanh, inverse_hyperbolic_tangent(a))
UNARY(SmoothCurve, smooth_curve(clamp(a, splat(0.0f), splat(1.0f))))
// 2^(-8 (1 - a)^2) between 0 and 1
MERISTEM_INLINE D gauss_curve(D a) {
  const D d = 1.0 - min(a, splat(1.0));
  return D(L(exponential(d * d * (-8 * ln2))) & L(a > 0.0));
}
UNARY_DOUBLE(GaussCurve, gauss_curve(a))

BINARY(Add, finite(a + b))
BINARY(Sub, finite(a - b))
BINARY(Mul, finite(a* b))
BINARY(Div, F(I(finite(a / b)) & ~I(b == 0.0f)))
BINARY_DOUBLE(Mod, modulo(a, b))
BINARY_DOUBLE(Fmod, remainder(a, b))
BINARY_DOUBLE(Pow, power(a, b))
BINARY(Min, min(a, b))
BINARY(Max, max(a, b))
BINARY_DOUBLE(Atan2, arc_tangent(a, b))
BINARY(Less, one_where(I(a < b)))
BINARY(LessEqual, one_where(I(a <= b)))
BINARY(Equal, one_where(I(a == b)))
BINARY(And, one_where(I(a != 0.0f) & I(b != 0.0f)))
BINARY(Or, one_where(I(a != 0.0f) | I(b != 0.0f)))

void Select(const KernelCall& c, int lanes) {
  ternary(
      c,
      lanes, [&](F condition, F a, F b) __attribute__((always_inline)) { return blend(b, a, I(condition != 0.0f)); });
}
void Mix(const KernelCall& c, int lanes) {
  ternary(
      c, lanes, [&](F a, F b, F t) __attribute__((always_inline)) {
        return finite(finite(a * finite(1.0f - t)) + finite(b * t));
      });
}

void Dot(const KernelCall& c, int lanes) {
  for_operands<6>(
      c, lanes, [&](const Operand* operands, int i) __attribute__((always_inline)) {
        const Point a = point_at(operands, i), b = point_at(operands + 3, i);
        return finite(finite(finite(a.x * b.x) + finite(a.y * b.y)) + finite(a.z * b.z));
      });
}
void Cross(const KernelCall& c, int lanes) {
  for_operands<6>(
      c, lanes, [&](const Operand* operands, int i) __attribute__((always_inline)) {
        const Point a = point_at(operands, i), b = point_at(operands + 3, i);
        auto minor = [&](F p, F q, F r, F s) __attribute__((always_inline)) {
          return finite(finite(p * q) - finite(r * s));
        };
        return Point{minor(a.y, b.z, a.z, b.y), minor(a.z, b.x, a.x, b.z), minor(a.x, b.y, a.y, b.x)};
      });
}

// Half of the lanes of a vector, as doubles.
struct PointD {
  D x, y, z;
};
MERISTEM_INLINE PointD lower_point(Point p) { return {lower_half(p.x), lower_half(p.y), lower_half(p.z)}; }
MERISTEM_INLINE PointD upper_point(Point p) { return {upper_half(p.x), upper_half(p.y), upper_half(p.z)}; }
MERISTEM_INLINE Point join_points(PointD a, PointD b) {
  return {join(finite(a.x), finite(b.x)), join(finite(a.y), finite(b.y)), join(finite(a.z), finite(b.z))};
}
MERISTEM_INLINE D dot(PointD a, PointD b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
MERISTEM_INLINE D length(PointD p) { return sqrt(dot(p, p)); }
MERISTEM_INLINE PointD normalized(PointD p) {
  const D l = length(p);
  const L some = L(l > 0.0);
  return {D(L(p.x / l) & some), D(L(p.y / l) & some), D(L(p.z / l) & some)};
}

void Length(const KernelCall& c, int lanes) {
  for_operands<3>(
      c, lanes, [&](const Operand* a, int i) __attribute__((always_inline)) {
        const Point p = point_at(a, i);
        return join(finite(length(lower_point(p))), finite(length(upper_point(p))));
      });
}
void Norm(const KernelCall& c, int lanes) {
  for_operands<3>(
      c, lanes, [&](const Operand* a, int i) __attribute__((always_inline)) {
        const Point p = point_at(a, i);
        return join_points(normalized(lower_point(p)), normalized(upper_point(p)));
      });
}

// Rodrigues' formula; v itself if the axis is zero.
MERISTEM_INLINE PointD rotated(PointD v, PointD axis, D angle) {
  const PointD k = normalized(axis);
  const D none = D(L(dot(k, k) == 0.0) & L(splat(1.0)));
  const D s = sine(angle, 0), cosine = sine(angle, 1) * (1.0 - none) + none;
  const D along = dot(k, v) * (1.0 - cosine);
  return {v.x * cosine + (k.y * v.z - k.z * v.y) * s + k.x * along,
          v.y * cosine + (k.z * v.x - k.x * v.z) * s + k.y * along,
          v.z * cosine + (k.x * v.y - k.y * v.x) * s + k.z * along};
}
void Rotate(const KernelCall& c, int lanes) {
  for_operands<7>(
      c, lanes, [&](const Operand* a, int i) __attribute__((always_inline)) {
        const Point v = point_at(a, i), axis = point_at(a + 3, i);
        const F angle = at(a[6], i);
        return join_points(rotated(lower_point(v), lower_point(axis), lower_half(angle)),
                           rotated(upper_point(v), upper_point(axis), upper_half(angle)));
      });
}

MERISTEM_INLINE F scaled(F n) { return n * noise_scale; }
MERISTEM_INLINE Point scaled(Point n) { return {n.x * noise_scale, n.y * noise_scale, n.z * noise_scale}; }

#define NOISE(name, Place, noise)                                               \
  void name(const KernelCall& c, int lanes) {                                   \
    for_operands<Place::dimensions>(                                            \
        c, lanes, [&](const Operand* a, int i) __attribute__((always_inline)) { \
          return scaled(noise(cell_of(clamp_point(place_at<Place>(a, i)))));    \
        });                                                                     \
  }
NOISE(Noise, Point, one_noise)
NOISE(VectorNoise, Point, vector_noise)
NOISE(Noise4, Point4, one_noise)
NOISE(VectorNoise4, Point4, vector_noise)

// Operands: point, periods.
void PeriodicNoise(const KernelCall& c, int lanes) {
  for_operands<6>(
      c, lanes, [&](const Operand* a, int i) __attribute__((always_inline)) {
        return scaled(one_noise(periodic_cell_of(clamp_point(point_at(a, i)), point_at(a + 3, i))));
      });
}

// Operands: place, lacunarity, gain; `parameter` octaves. The sum of shape(noise of octave k) * gain^k.
template <class Place, class Noise, class Shape>
MERISTEM_INLINE void octaves(const KernelCall& c, int lanes, Noise noise, Shape shape) {
  const int count = c.parameter;
  constexpr int dimensions = Place::dimensions;
  for_operands<dimensions + 2>(
      c, lanes, [&](const Operand* a, int i) __attribute__((always_inline)) {
        Place p = clamp_point(place_at<Place>(a, i));
        const F lacunarity = limit(at(a[dimensions], i), max_lacunarity);
        const F gain = limit(at(a[dimensions + 1], i), max_gain);
        F amplitude = splat(noise_scale);
        decltype(noise(cell_of(p))) sum{};
        for (int k = 0; k < count; ++k) {
          const auto cell = cell_of(p);
          p = next_octave(p, lacunarity,
                          octave_shifts[std::size_t(k)]);  // before the sum: its latency hides behind that
          add_scaled(sum, shape(noise(cell)), amplitude);
          amplitude *= gain;
        }
        return sum;
      });
}
#define OCTAVES(name, Place, noise, shape)                                                      \
  void name(const KernelCall& c, int lanes) {                                                   \
    octaves<Place>(                                                                             \
        c, lanes, [&](const auto& cell) __attribute__((always_inline)) { return noise(cell); }, \
        [&](auto n) __attribute__((always_inline)) { return shape; });                          \
  }
OCTAVES(Fbm, Point, one_noise, n)
OCTAVES(VectorFbm, Point, vector_noise, n)
OCTAVES(Turbulence, Point, one_noise, absolute(n))
OCTAVES(VectorTurbulence, Point, vector_noise, absolute(n))
OCTAVES(Fbm4, Point4, one_noise, n)
OCTAVES(VectorFbm4, Point4, vector_noise, n)

void CellNoise(const KernelCall& c, int lanes) {
  for_operands<3>(
      c, lanes, [&](const Operand* a, int i) __attribute__((always_inline)) {
        return uniform(cell_hash(point_at(a, i)));
      });
}
void CellColor(const KernelCall& c, int lanes) {
  for_operands<3>(
      c, lanes, [&](const Operand* a, int i) __attribute__((always_inline)) {
        return color_of(cell_hash(point_at(a, i)));
      });
}
void Voronoi(const KernelCall& c, int lanes) {
  for_operands<4>(c, lanes, [&](const Operand* a, int i) {
    Point cell, local;
    const Features f = find_features(point_at(a, i), at(a[3], i), cell, local);
    return voronoi_value(f, local, c.parameter);
  });
}
void VoronoiPosition(const KernelCall& c, int lanes) {
  for_operands<4>(c, lanes, [&](const Operand* a, int i) {
    Point cell, local;
    const Point q = find_features(point_at(a, i), at(a[3], i), cell, local).position1;
    return Point{cell.x + q.x, cell.y + q.y, cell.z + q.z};
  });
}
void VoronoiColor(const KernelCall& c, int lanes) {
  for_operands<4>(c, lanes, [&](const Operand* a, int i) {
    Point cell, local;
    return color_of(find_features(point_at(a, i), at(a[3], i), cell, local).hash1);
  });
}

void Hash(const KernelCall& c, int lanes) {
  for_lanes(c, lanes, [&](int i) {
    U h = U{} + std::uint32_t(c.operand_count);
    for (int k = 0; k < c.operand_count; ++k)
      h = scramble(h * 0x9e3779b1u + U(at(c.operands[k], i) + 0.0f));  // + 0: -0 is 0
    return uniform(h);
  });
}

// Catmull-Rom through the operands after the first, which is the place in [0, 1]; the outer two only give tangents.
void Spline(const KernelCall& c, int lanes) {
  const int segments = c.operand_count - 4;
  for_lanes(c, lanes, [&](int i) {
    const F u = clamp(at(c.operands[0], i), splat(0.0f), splat(1.0f)) * float(segments);
    const F segment = min(floor(u), splat(float(segments - 1)));
    const F t = u - segment;
    F y0 = at(c.operands[1], i), y1 = at(c.operands[2], i), y2 = at(c.operands[3], i), y3 = at(c.operands[4], i);
    for (int k = 1; k < segments; ++k) {
      const I here = I(segment >= float(k));
      y0 = blend(y0, at(c.operands[k + 1], i), here);
      y1 = blend(y1, at(c.operands[k + 2], i), here);
      y2 = blend(y2, at(c.operands[k + 3], i), here);
      y3 = blend(y3, at(c.operands[k + 4], i), here);
    }
    auto weigh = [&](F w, F y) __attribute__((always_inline)) { return finite(w * y); };
    const F t2 = t * t, t3 = t2 * t;
    const F outer = finite(weigh((2.0f * t2 - t3 - t) * 0.5f, y0) + weigh((t3 - t2) * 0.5f, y3));
    const F inner =
        finite(weigh((3.0f * t3 - 5.0f * t2 + 2.0f) * 0.5f, y1) + weigh((4.0f * t2 - 3.0f * t3 + t) * 0.5f, y2));
    return finite(outer + inner);
  });
}

void Curve(const KernelCall& c, int lanes) {
  for_operands<1>(c, lanes, [&](const Operand* place, int i) {
    const F x = at(place[0], i);
    F start = splat(c.pieces[0].start), c0 = splat(c.pieces[0].c0), c1{}, c2{}, c3{};  // the first piece is constant
    for (int k = 1; k < c.parameter; ++k) {
      const CurvePiece& piece = c.pieces[k];
      const I here = I(x >= piece.start);
      start = blend(start, splat(piece.start), here);
      c0 = blend(c0, splat(piece.c0), here);
      c1 = blend(c1, splat(piece.c1), here);
      c2 = blend(c2, splat(piece.c2), here);
      c3 = blend(c3, splat(piece.c3), here);
    }
    const F t = finite(x - start);
    auto step = [&](F a, F b) __attribute__((always_inline)) { return finite(a + finite(t * b)); };
    return step(c0, step(c1, step(c2, c3)));
  });
}

constexpr Kernel Rand = nullptr;
constexpr Kernel GridValue = nullptr;
constexpr Kernel GridGradient = nullptr;

}  // namespace kernel

constexpr KernelTable table = {width == 16  ? "AVX-512"
                               : width == 8 ? "AVX2"
                                            : "SSE4.2",
                               width,
                               {
#define X(name) kernel::name,
                                   MERISTEM_OPS(X)
#undef X
                               }};

}  // namespace
}  // namespace meristem
