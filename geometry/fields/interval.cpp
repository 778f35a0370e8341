#include "geometry/fields/interval.h"

#include "geometry/base/check.h"
#include "geometry/base/scratch.h"
#include "geometry/fields/noise_bounds.h"
#include "geometry/fields/range.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace meristem {

namespace {

using namespace bounds;

Range square(Range a) {
  const Range m = absolute(a);
  return {m.lower * m.lower, m.upper * m.upper};
}
Range divide(Range a, Range b) {
  if (b.lower > smallest || b.upper < -smallest) return multiply(a, {1 / b.upper, 1 / b.lower});
  // x / 0 is 0; near it the quotient has any size, but its sign is known if both are
  if (b.lower >= 0 && a.lower >= 0) return {0, largest};
  if (b.lower >= 0 && a.upper <= 0) return {-largest, 0};
  return {-largest, largest};
}

template <class Function>
Range rising(Function f, Range a) {
  return {f(a.lower), f(a.upper)};
}
template <class Function>
Range rounded_rising(Function f, Range a) {
  return rounded(rising(f, a));
}

// The sine over an interval, shifted by a quarter of the circle for the cosine: extrema at odd quarters.
Range sine(Range a, double shift) {
  if (a.magnitude() > 0x1p29 || a.upper - a.lower >= 2 * pi) return {-1, 1};
  const Range s{a.lower + shift, a.upper + shift};
  auto reaches = [&](double phase) {  // with a margin for the rounding of the shift
    return std::floor((s.upper - phase) / (2 * pi) + 1e-9) > std::floor((s.lower - phase) / (2 * pi) - 1e-9);
  };
  Range r{std::min(std::sin(s.lower), std::sin(s.upper)), std::max(std::sin(s.lower), std::sin(s.upper))};
  r = clipped(rounded({r.lower - 1e-9, r.upper + 1e-9}), -1, 1);
  if (reaches(pi / 2)) r.upper = 1;
  if (reaches(-pi / 2)) r.lower = -1;
  return r;
}
Range tangent(Range a) {
  const double first = std::floor(a.lower / pi + 0.5 - 1e-9), last = std::floor(a.upper / pi + 0.5 + 1e-9);
  if (a.magnitude() > 0x1p29 || first != last) return {-largest, largest};
  return rounded_rising([](double v) { return std::tan(v); }, a);
}
Range hyperbolic_cosine(Range a) {
  auto f = [](double v) { return std::cosh(std::min(v, 200.0)); };
  return rounded_rising(f, absolute(a));
}

// x^y by the corners of the logarithms: monotone in each. x not negative.
Range positive_power(Range x, Range y) {
  const Range base{std::max(x.lower, smallest), std::max(x.upper, smallest)};
  Range r{infinity, -infinity};
  for (double b : {base.lower, base.upper})
    for (double e : {y.lower, y.upper}) {
      const double v = std::exp(std::clamp(e * std::log(b), -200.0, 200.0));
      r = hull(r, {v, v});
    }
  r = rounded({r.lower * (1 - 1e-12), r.upper * (1 + 1e-12)});
  if (x.lower < smallest) r.lower = 0;  // a zero base
  if (y.contains(0)) r = hull(r, {1, 1});
  return {std::max(r.lower, 0.0), r.upper};
}
Range power(Range x, Range y) {
  if (x.lower >= 0) return positive_power(x, y);
  const Range m = positive_power(absolute(x), y);
  const bool whole = y.lower == y.upper && y.lower == std::floor(y.lower);
  if (!whole) return {-m.upper, m.upper};
  if (std::fmod(y.lower, 2) == 0) return m;
  if (y.lower < 0 || x.upper > 0) return {-m.upper, x.upper > 0 ? m.upper : 0};
  return {-m.upper, -m.lower};
}

Range modulo(Range x, Range y) {
  if (y.lower == y.upper && y.lower > smallest) {
    const double turn = std::floor(x.lower / y.lower);
    const Range r{x.lower - turn * y.lower, x.upper - turn * y.lower};
    const bool one_turn =
        x.magnitude() / y.lower < 0x1p24 && r.lower > 1e-6 * y.lower && r.upper < (1 - 1e-6) * y.lower;
    if (one_turn) return clipped(rounded({r.lower - 1e-9 * x.magnitude(), r.upper + 1e-9 * x.magnitude()}), 0, y.lower);
  }
  return {std::min(y.lower, 0.0), std::max(y.upper, 0.0)};
}
Range remainder(Range x, Range y) {
  const double most = std::min(x.magnitude(), y.magnitude());
  return {x.lower < 0 ? -most : 0, x.upper > 0 ? most : 0};
}

Range arc_tangent(Range y, Range x) {
  const bool cut =
      x.lower <= smallest && y.lower <= smallest && y.upper >= -smallest;  // the negative x axis, or the origin
  if (cut) return clipped(rounded({-pi, pi}), -3.1415928, 3.1415928);
  Range r{infinity, -infinity};  // off the cut the angle's extrema are at corners of the box
  for (double b : {y.lower, y.upper})
    for (double a : {x.lower, x.upper}) r = hull(r, {std::atan2(b, a), std::atan2(b, a)});
  return rounded(r);
}

Range truth(bool always, bool never) { return {always ? 1.0 : 0.0, never ? 0.0 : 1.0}; }
bool is_true(Range a) { return a.lower > 0 || a.upper < 0; }
bool is_false(Range a) { return a.lower == 0 && a.upper == 0; }

Range mix(Range a, Range b, Range t) {
  Range r{infinity, -infinity};  // linear in each: extrema at corners
  for (double u : {t.lower, t.upper}) {
    r = hull(r, add(multiply(a, {1 - u, 1 - u}), multiply(b, {u, u})));
  }
  const double error = (a.magnitude() + b.magnitude()) * std::max(1.0, t.magnitude()) * 0x1p-21;
  return rounded({r.lower - error, r.upper + error});
}

double smooth_curve(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}
double gauss_curve(double t) { return t <= 0 ? 0 : std::exp2(-8 * (1 - std::min(t, 1.0)) * (1 - std::min(t, 1.0))); }

Range unary(Op op, Range a) {
  auto libm = [](double (*f)(double)) { return f; };
  auto exact = [&](auto f) { return rising(f, a); };
  switch (op) {
    case Op::Not: return truth(is_false(a), is_true(a));
    case Op::Abs: return absolute(a);
    case Op::Sign: return exact([](double v) { return v > 0 ? 1.0 : v < 0 ? -1.0 : 0.0; });
    case Op::Floor: return exact([](double v) { return std::floor(v); });
    case Op::Ceil: return exact([](double v) { return std::ceil(v); });
    case Op::Round: return exact([](double v) { return double(std::floor(float(v) + 0.5f)); });
    case Op::Trunc: return exact([](double v) { return std::trunc(v); });
    case Op::Sqrt: return clipped(rounded(exact([](double v) { return std::sqrt(std::max(v, 0.0)); })), 0, largest);
    case Op::Cbrt: return rounded(exact(libm(std::cbrt)));
    case Op::Exp:
      return clipped(rounded(exact([](double v) { return std::exp(std::clamp(v, -200.0, 200.0)); })), 0, largest);
    case Op::Log: return rounded(exact([](double v) { return std::log(std::max(v, smallest)); }));
    case Op::Log10: return rounded(exact([](double v) { return std::log10(std::max(v, smallest)); }));
    case Op::Sin: return sine(a, 0);
    case Op::Cos: return sine(a, pi / 2);
    case Op::Tan: return tangent(a);
    case Op::Asin: return rounded(exact([](double v) { return std::asin(std::clamp(v, -1.0, 1.0)); }));
    case Op::Acos:
      return rounded(Range{std::acos(std::clamp(a.upper, -1.0, 1.0)), std::acos(std::clamp(a.lower, -1.0, 1.0))});
    case Op::Atan: return rounded(exact(libm(std::atan)));
    case Op::Sinh: return rounded(exact([](double v) { return std::sinh(std::clamp(v, -200.0, 200.0)); }));
    case Op::Cosh: return hyperbolic_cosine(a);
    case Op::Tanh: return clipped(rounded(exact(libm(std::tanh))), -1, 1);
    case Op::Asinh: return rounded(exact(libm(std::asinh)));
    case Op::Acosh: return clipped(rounded(exact([](double v) { return std::acosh(std::max(v, 1.0)); })), 0, largest);
    case Op::Atanh:
      return rounded(exact([](double v) { return std::atanh(std::clamp(v, -1 + 0x1p-24, 1 - 0x1p-24)); }));
    case Op::SmoothCurve:
      return clipped(rounded(Range{smooth_curve(a.lower) - 1e-6, smooth_curve(a.upper) + 1e-6}), 0, 1.000001);
    case Op::GaussCurve: return clipped(rounded(exact(gauss_curve)), 0, 1);
    default: CHECK(false, "operation {}", int(op));
  }
}

Range binary(Op op, Range a, Range b, bool same) {
  switch (op) {
    case Op::Add: return rounded(add(a, b));
    case Op::Sub: return same ? Range{0, 0} : rounded(subtract(a, b));
    case Op::Mul: return same ? clipped(rounded(square(a)), 0, largest) : rounded(multiply(a, b));
    case Op::Div: {
      const Range r = rounded(divide(a, b));  // keeps a known sign
      return {a.lower >= 0 && b.lower >= 0 ? std::max(r.lower, 0.0) : r.lower, r.upper};
    }
    case Op::Mod: return modulo(a, b);
    case Op::Fmod: return remainder(a, b);
    case Op::Pow: return power(a, b);
    case Op::Min: return {std::min(a.lower, b.lower), std::min(a.upper, b.upper)};
    case Op::Max: return {std::max(a.lower, b.lower), std::max(a.upper, b.upper)};
    case Op::Atan2: return arc_tangent(a, b);
    case Op::Less: return same ? Range{0, 0} : truth(a.upper < b.lower, a.lower >= b.upper);
    case Op::LessEqual: return same ? Range{1, 1} : truth(a.upper <= b.lower, a.lower > b.upper);
    case Op::Equal:
      return same ? Range{1, 1}
                  : truth(a.lower == b.upper && a.upper == b.lower, a.upper < b.lower || b.upper < a.lower);
    case Op::And: return truth(is_true(a) && is_true(b), is_false(a) || is_false(b));
    case Op::Or: return truth(is_true(a) || is_true(b), is_false(a) && is_false(b));
    default: CHECK(false, "operation {}", int(op));
  }
}

Range ternary(Op op, Range a, Range b, Range c) {
  if (op == Op::Mix) return mix(a, b, c);
  if (is_true(a)) return b;
  return is_false(a) ? c : hull(b, c);
}

// A vector's ranges with a bound on its length.
struct Bound {
  Box box;
  double length = infinity;
};

// Of floats, whose squares a double holds.
double box_length(const Box& b) {
  const double x = b[0].magnitude(), y = b[1].magnitude(), z = b[2].magnitude();
  return std::sqrt(x * x + y * y + z * z);
}

// What an input may be: a finite number; a denormal one may act as 0.
Range input_range(Interval i) {
  Range r = clipped(range_of(i), -largest, largest);
  if (r.lower > 0 && r.lower < smallest) r.lower = 0;
  if (r.upper < 0 && r.upper > -smallest) r.upper = 0;
  return r;
}

Bound bound_of(const IntervalValue& v) {
  return {{input_range(v.x), input_range(v.y), input_range(v.z)}, double(v.max_length)};
}

// Components and length sharpen each other; the length is of the float results, so it is rounded too.
IntervalValue vector_value(Bound b) {
  const double length = std::min(b.length, box_length(b.box)) * (1 + 0x1p-20) + 4 * smallest;
  for (Range& r : b.box) r = clipped(r, rounded({-length, length}));
  const float bound = length < largest ? next_up(float(length)) : INFINITY;
  return {interval_of(b.box[0]), interval_of(b.box[1]), interval_of(b.box[2]), bound};
}
IntervalValue scalar_value(Range r) { return IntervalValue::scalar(float(r.lower), float(r.upper)); }

// One piece of a curve over t in [0, width]: a cubic's extrema are at the ends and where its derivative vanishes.
Range piece_range(const CurvePiece& p, double from, double to) {
  auto value = [&](double t) { return p.c0 + t * (double(p.c1) + t * (double(p.c2) + t * p.c3)); };
  Range r = hull({value(from), value(from)}, {value(to), value(to)});
  const double a = 3.0 * p.c3, b = p.c2, c = p.c1, root = b * b - a * c;  // a t^2 + 2 b t + c = 0
  auto visit = [&](double t) {
    if (t > from && t < to) r = hull(r, {value(t), value(t)});
  };
  if (root >= 0) {
    const double q = -(b + std::copysign(std::sqrt(root), b));
    if (a != 0) visit(q / a);
    if (q != 0) visit(c / q);
  }
  const double t = std::max(std::abs(from), std::abs(to));
  const double error = 0x1p-21 * (std::abs(p.c0) + t * (std::abs(p.c1) + t * (std::abs(p.c2) + t * std::abs(p.c3))));
  return rounded({r.lower - error, r.upper + error});
}
Range curve_range(const CurveTable& table, Range x) {
  Range r{infinity, -infinity};
  for (std::size_t i = 0; i < table.pieces.size(); ++i) {
    const CurvePiece& p = table.pieces[i];
    const double end = i + 1 < table.pieces.size() ? table.pieces[i + 1].start : infinity;
    if (x.upper < p.start || x.lower >= end) continue;
    const bool flat = p.c1 == 0 && p.c2 == 0 && p.c3 == 0;
    r = hull(r, flat ? Range{p.c0, p.c0}
                     : piece_range(p, std::max(x.lower, double(p.start)) - p.start, std::min(x.upper, end) - p.start));
  }
  return r;
}

// The evaluation of bounds over one graph.
class Evaluation {
 public:
  Evaluation(const Graph& graph, std::span<const IntervalValue> inputs)
      : g_(graph), inputs_(inputs), values_(graph.size()) {}

  IntervalValue run(NodeId result) {
    for (NodeId i = 0; i <= result; ++i) values_[std::size_t(i)] = value_of(g_.node(i));
    return values_[std::size_t(result)];
  }

 private:
  const IntervalValue& value(NodeId id) const { return values_[std::size_t(id)]; }
  Range scalar(NodeId id) const { return range_of(value(id).x); }
  Bound bound(NodeId id) const { return bound_of(value(id)); }
  // Component c; a scalar stands for all.
  Range component(NodeId id, int c) const {
    const IntervalValue& v = value(id);
    return range_of(c == 0 || !g_.is_vector(id) ? v.x : c == 1 ? v.y : v.z);
  }

  IntervalValue value_of(const Node& n) const {
    const auto a = g_.arguments(n);
    if (is_componentwise(n.op)) return componentwise(n, a);
    switch (n.op) {
      case Op::Constant: return scalar_value({n.value, n.value});
      case Op::Input: return input(n);
      case Op::Component: return scalar_value(component(a[0], n.parameter));
      case Op::MakeVector: return vector_value({{scalar(a[0]), scalar(a[1]), scalar(a[2])}});
      case Op::Dot: return dot(a);
      case Op::Length: return length(a[0]);
      case Op::Cross: return cross(a);
      case Op::Norm: return normalized(a[0]);
      case Op::Rotate: return rotated(a[0]);
      case Op::Curve: return scalar_value(curve_range(g_.curve_table(n.parameter), scalar(a[0])));
      case Op::Spline: return spline(a);
      default: return chance_or_noise(n, a);
    }
  }

  IntervalValue input(const Node& n) const {
    CHECK(std::size_t(n.parameter) < inputs_.size(), "input {} of {}", n.parameter, inputs_.size());
    const IntervalValue& v = inputs_[std::size_t(n.parameter)];
    if (n.type == ValueType::Vector) return vector_value(bound_of(v));
    return scalar_value(input_range(v.x));
  }

  IntervalValue componentwise(const Node& n, std::span<const NodeId> a) const {
    auto one = [&](int c) {
      if (a.size() == 1) return unary(n.op, component(a[0], c));
      if (a.size() == 2) return binary(n.op, component(a[0], c), component(a[1], c), a[0] == a[1]);
      return ternary(n.op, component(a[0], c), component(a[1], c), component(a[2], c));
    };
    if (n.type == ValueType::Scalar) return scalar_value(one(0));
    return vector_value({{one(0), one(1), one(2)}, length_of(n, a)});
  }

  // A bound on the length of a componentwise result that its components do not give.
  double length_of(const Node& n, std::span<const NodeId> a) const {
    auto length = [&](NodeId id) { return g_.is_vector(id) ? double(value(id).max_length) : infinity; };
    auto factor = [&](NodeId id) { return g_.is_vector(id) ? infinity : scalar(id).magnitude(); };
    auto product = [](double l, double f) { return f == 0 ? 0 : l * f; };
    switch (n.op) {
      case Op::Add:
      case Op::Sub:
        if (n.op == Op::Sub && is_false(component(a[0], 0)) && !g_.is_vector(a[0])) return length(a[1]);
        return length(a[0]) + length(a[1]);
      case Op::Mul: return std::min(product(length(a[0]), factor(a[1])), product(length(a[1]), factor(a[0])));
      case Op::Div: {
        const Range d = g_.is_vector(a[1]) ? Range{} : scalar(a[1]);
        const double least = d.lower > 0 ? d.lower : d.upper < 0 ? -d.upper : 0;
        return least > smallest ? length(a[0]) / least : infinity;
      }
      case Op::Mix: {
        const bool between = !g_.is_vector(a[2]) && scalar(a[2]).lower >= 0 && scalar(a[2]).upper <= 1;
        return between ? std::max(length(a[0]), length(a[1])) : infinity;
      }
      case Op::Select: return g_.is_vector(a[0]) ? infinity : std::max(length(a[1]), length(a[2]));
      case Op::Abs:
      case Op::Trunc: return length(a[0]);
      default: return infinity;
    }
  }

  IntervalValue dot(std::span<const NodeId> a) const {
    Range sum{0, 0};
    double terms = 0;
    for (int c = 0; c < 3; ++c) {
      const Range x = component(a[0], c), y = component(a[1], c);
      sum = add(sum, a[0] == a[1] ? square(x) : multiply(x, y));
      terms += x.magnitude() * y.magnitude();
    }
    const double error = std::min(terms, largest) * 0x1p-21;  // of the sums, which may cancel
    const double most = double(value(a[0]).max_length) * double(value(a[1]).max_length);
    Range r = rounded({sum.lower - error, sum.upper + error});
    if (most < largest) r = clipped(r, rounded({-most - error, most + error}));
    return scalar_value(a[0] == a[1] ? clipped(r, 0, largest) : r);
  }
  IntervalValue length(NodeId a) const {
    double least = 0;
    for (int c = 0; c < 3; ++c) least = std::hypot(least, absolute(component(a, c)).lower);
    const double most = std::min(double(value(a).max_length), box_length(bound(a).box));
    return scalar_value(clipped(rounded({least, most}), 0, largest));
  }
  IntervalValue cross(std::span<const NodeId> a) const {
    Box box;
    double error = 0;
    for (int c = 0; c < 3; ++c) {
      const int d = (c + 1) % 3, e = (c + 2) % 3;
      const Range p = multiply(component(a[0], d), component(a[1], e)),
                  q = multiply(component(a[0], e), component(a[1], d));
      const double here = std::min(p.magnitude() + q.magnitude(), largest) * 0x1p-21;
      const Range r = subtract(p, q);
      box[std::size_t(c)] = rounded({r.lower - here, r.upper + here});
      error += here;
    }
    return vector_value({box, double(value(a[0]).max_length) * double(value(a[1]).max_length) + error});
  }
  IntervalValue normalized(NodeId a) const {
    Box box;
    for (int c = 0; c < 3; ++c) {
      const Range r = component(a, c);
      box[std::size_t(c)] = {r.lower >= 0 ? 0.0 : -1.0, r.upper <= 0 ? 0.0 : 1.0};
    }
    return vector_value({box, 1});
  }
  IntervalValue rotated(NodeId a) const {
    const double most = std::min(double(value(a).max_length), box_length(bound(a).box)) * (1 + 0x1p-20) + 4 * smallest;
    const Range r = rounded({-most, most});
    return vector_value({{r, r, r}, most});
  }
  // Catmull-Rom leaves the hull of its values by at most an eighth of its width.
  IntervalValue spline(std::span<const NodeId> a) const {
    Range r = scalar(a[1]);
    for (NodeId y : a.subspan(2)) r = hull(r, scalar(y));
    const double over = (r.upper - r.lower) / 8 + r.magnitude() * 0x1p-20;
    return scalar_value(rounded({r.lower - over, r.upper + over}));
  }

  IntervalValue chance_or_noise(const Node& n, std::span<const NodeId> a) const {
    switch (n.op) {
      case Op::Noise:
      case Op::VectorNoise:
      case Op::Fbm:
      case Op::VectorFbm:
      case Op::Turbulence:
      case Op::VectorTurbulence:
      case Op::Noise4:
      case Op::VectorNoise4:
      case Op::Fbm4:
      case Op::VectorFbm4:
      case Op::PeriodicNoise: return gradient_noise(n, a);
      case Op::CellColor:
      case Op::VoronoiColor: return vector_value({{Range{0, 1}, Range{0, 1}, Range{0, 1}}});
      case Op::Voronoi: return scalar_value(voronoi(n.parameter));
      case Op::VoronoiPosition: return voronoi_position(a[0]);
      case Op::GridValue: return scalar_value(range_of(g_.grid(n.parameter).value_bounds(box_of(a[0]))));
      case Op::GridGradient: return grid_gradient(n, a[0]);
      default: return scalar_value({0, 1});  // CellNoise, Rand, Hash
    }
  }
  Bounds3d box_of(NodeId a) const {
    const Range x = component(a, 0), y = component(a, 1), z = component(a, 2);
    return {{x.lower, y.lower, z.lower}, {x.upper, y.upper, z.upper}};
  }
  IntervalValue grid_gradient(const Node& n, NodeId a) const {
    const Range r = range_of(g_.grid(n.parameter).gradient_bounds(box_of(a)));
    return vector_value({{r, r, r}});
  }
  // The nearest point is no further than the own cell's, the second no further than that of the nearest neighbour.
  static Range voronoi(int type) {
    const double nearest = 1.7321, second = 2.0616;
    switch (type) {
      case 1: return {0, nearest};
      case 2:
      case 3: return {0, second};
      case 4: return {0, 1.000001};
      default: return {0, (nearest + second) / 2};
    }
  }
  IntervalValue voronoi_position(NodeId a) const {
    Box box;
    for (int c = 0; c < 3; ++c) {
      const Range r = clipped(component(a, c), -0x1p24, 0x1p24);
      box[std::size_t(c)] = rounded({r.lower - 1.7321, r.upper + 1.7321});
    }
    return vector_value({box});
  }

  IntervalValue gradient_noise(const Node& n, std::span<const NodeId> a) const {
    NoisePlaces places{n.op, n.parameter};
    for (int c = 0; c < 3; ++c) places.place[std::size_t(c)] = component(a[0], c);
    if (noise_dimensions(n.op) == 4) places.place[3] = scalar(a[1]);
    if (n.op == Op::PeriodicNoise)
      for (int c = 0; c < 3; ++c) places.period[std::size_t(c)] = component(a[1], c);
    if (has_octaves(n.op)) {
      places.lacunarity = scalar(a[a.size() - 2]);
      places.gain = scalar(a[a.size() - 1]);
    }
    const Box box = noise_bounds(places);
    return n.type == ValueType::Vector ? vector_value({box}) : scalar_value(box[0]);
  }

  const Graph& g_;
  std::span<const IntervalValue> inputs_;
  Scratch<IntervalValue> values_;
};

}  // namespace

IntervalValue bounds_of(const Graph& graph, NodeId result, std::span<const IntervalValue> inputs) {
  return Evaluation(graph, inputs).run(result);
}

}  // namespace meristem
