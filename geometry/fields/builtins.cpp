#include "geometry/fields/builtins.h"

#include "geometry/fields/noise_constants.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace meristem {

namespace {

using Arguments = std::span<const NodeId>;

// Shorthands for building: B is a graph with operators as functions.
struct Builder {
  explicit Builder(CallContext& c) : call(c), g(c.graph()) {}

  NodeId number(double v) { return g.constant(float(v)); }
  NodeId add(NodeId a, NodeId b) { return g.make(Op::Add, {a, b}); }
  NodeId sub(NodeId a, NodeId b) { return g.make(Op::Sub, {a, b}); }
  NodeId mul(NodeId a, NodeId b) { return g.make(Op::Mul, {a, b}); }
  NodeId div(NodeId a, NodeId b) { return g.make(Op::Div, {a, b}); }
  NodeId min(NodeId a, NodeId b) { return g.make(Op::Min, {a, b}); }
  NodeId max(NodeId a, NodeId b) { return g.make(Op::Max, {a, b}); }
  NodeId less(NodeId a, NodeId b) { return g.make(Op::Less, {a, b}); }
  NodeId at_least(NodeId a, NodeId b) { return g.make(Op::LessEqual, {b, a}); }
  NodeId equal(NodeId a, NodeId b) { return g.make(Op::Equal, {a, b}); }
  NodeId select(NodeId condition, NodeId a, NodeId b) { return g.make(Op::Select, {condition, a, b}); }
  NodeId mix(NodeId a, NodeId b, NodeId t) { return g.make(Op::Mix, {a, b, t}); }
  NodeId unary(Op op, NodeId a) { return g.make(op, {a}); }
  NodeId clamp(NodeId a, NodeId lower, NodeId upper) { return min(max(a, lower), upper); }
  NodeId unit_clamp(NodeId a) { return clamp(a, number(0), number(1)); }
  NodeId pow(NodeId a, NodeId b) { return g.make(Op::Pow, {a, b}); }
  NodeId argument_or(Arguments a, std::size_t i, double fallback) { return i < a.size() ? a[i] : number(fallback); }

  // A constant integer argument within [lower, upper].
  int integer(Arguments a, std::size_t i, int fallback, int lower, int upper, const char* what) {
    if (i >= a.size()) return fallback;
    const float v = g.constant_value(a[i]).x;
    if (v != std::floor(v) || v < float(lower) || v > float(upper))
      call.fail(i, fmt::format("{} must be a whole number from {} to {}, not {}", what, lower, upper, v));
    return int(v);
  }

  CallContext& call;
  Graph& g;
};

template <Op op>
NodeId direct(CallContext& call, Arguments a) {
  return call.graph().make(op, a);
}

// f of the argument in radians; and of an angle, in degrees.
template <Op op>
NodeId of_degrees(CallContext& call, Arguments a) {
  Builder b(call);
  return b.unary(op, b.mul(a[0], b.number(pi / 180)));
}
template <Op op>
NodeId in_degrees(CallContext& call, Arguments a) {
  Builder b(call);
  return b.mul(b.g.make(op, a), b.number(180 / pi));
}

// min and max of any number of arguments.
template <Op op>
NodeId fold_all(CallContext& call, Arguments a) {
  NodeId result = a[0];
  for (NodeId next : a.subspan(1)) result = call.graph().make(op, {result, next});
  return result;
}

NodeId clamp(CallContext& call, Arguments a) { return Builder(call).clamp(a[0], a[1], a[2]); }
NodeId deg(CallContext& call, Arguments a) {
  Builder b(call);
  return b.mul(a[0], b.number(180 / pi));
}
NodeId rad(CallContext& call, Arguments a) {
  Builder b(call);
  return b.mul(a[0], b.number(pi / 180));
}
NodeId invert(CallContext& call, Arguments a) {
  Builder b(call);
  return b.sub(b.number(1), a[0]);
}
NodeId hypot(CallContext& call, Arguments a) {
  Builder b(call);
  return b.unary(Op::Length, b.g.make_vector(a[0], a[1], b.number(0)));
}

NodeId compress(CallContext& call, Arguments a) { return Builder(call).mix(a[1], a[2], a[0]); }
NodeId boxstep(CallContext& call, Arguments a) { return Builder(call).at_least(a[0], a[1]); }

// Where x lies between a (0) and b (1), not clamped; a step if a and b are equal.
NodeId place_between(Builder& b, NodeId x, NodeId from, NodeId to) {
  return b.select(b.equal(from, to), b.at_least(x, from), b.div(b.sub(x, from), b.sub(to, from)));
}
NodeId expand(CallContext& call, Arguments a) {
  Builder b(call);
  return place_between(b, a[0], a[1], a[2]);
}
NodeId linearstep(CallContext& call, Arguments a) {
  Builder b(call);
  return b.unit_clamp(place_between(b, a[0], a[1], a[2]));
}
NodeId smoothstep(CallContext& call, Arguments a) {
  Builder b(call);
  return b.unary(Op::SmoothCurve, place_between(b, a[0], a[1], a[2]));
}
NodeId gaussstep(CallContext& call, Arguments a) {
  Builder b(call);
  return b.unary(Op::GaussCurve, place_between(b, a[0], a[1], a[2]));
}
NodeId fit(CallContext& call, Arguments a) {
  Builder b(call);
  return b.mix(a[3], a[4], place_between(b, a[0], a[1], a[2]));
}

NodeId remap(CallContext& call, Arguments a) {
  Builder b(call);
  const NodeId range = b.unary(Op::Abs, a[2]), falloff = b.unary(Op::Abs, a[3]);
  const NodeId distance = b.unary(Op::Abs, b.sub(a[0], a[1]));
  const NodeId place = b.div(b.sub(b.add(range, falloff), distance), falloff);
  const NodeId interpolation = b.unary(Op::Trunc, a[4]);
  const NodeId soft = b.select(
      b.equal(interpolation, b.number(0)), b.unit_clamp(place),
      b.select(b.equal(interpolation, b.number(1)), b.unary(Op::SmoothCurve, place), b.unary(Op::GaussCurve, place)));
  return b.select(b.equal(falloff, b.number(0)), b.less(distance, range), soft);
}

NodeId gamma(CallContext& call, Arguments a) {
  Builder b(call);
  return b.pow(a[0], b.div(b.number(1), a[1]));
}
NodeId bias_of(Builder& b, NodeId x, NodeId amount) {
  return b.pow(x, b.mul(b.unary(Op::Log, amount), b.number(1 / std::log(0.5))));
}
NodeId bias(CallContext& call, Arguments a) {
  Builder b(call);
  return bias_of(b, a[0], a[1]);
}
NodeId contrast(CallContext& call, Arguments a) {
  Builder b(call);
  const NodeId half = b.number(0.5), one = b.number(1), amount = b.sub(one, a[1]), twice = b.mul(b.number(2), a[0]);
  const NodeId lower = b.mul(half, bias_of(b, b.unit_clamp(twice), amount));
  const NodeId upper = b.sub(one, b.mul(half, bias_of(b, b.unit_clamp(b.sub(b.number(2), twice)), amount)));
  return b.select(b.less(a[0], half), lower, upper);
}

NodeId angle(CallContext& call, Arguments a) {
  Builder b(call);
  return b.unary(Op::Acos, b.g.make(Op::Dot, {b.unary(Op::Norm, a[0]), b.unary(Op::Norm, a[1])}));
}
NodeId dist(CallContext& call, Arguments a) {
  Builder b(call);
  return b.unary(Op::Length, b.sub(a[0], a[1]));
}
NodeId ortho(CallContext& call, Arguments a) {
  Builder b(call);
  return b.unary(Op::Norm, b.g.make(Op::Cross, a));
}
NodeId up(CallContext& call, Arguments a) {
  Builder b(call);
  const NodeId y = b.g.make_vector(b.number(0), b.number(1), b.number(0));
  const NodeId x = b.g.make_vector(b.number(1), b.number(0), b.number(0));
  const NodeId across = b.g.make(Op::Cross, {y, a[1]});
  const NodeId axis = b.select(b.equal(b.unary(Op::Length, across), b.number(0)), x, across);
  return b.g.make(Op::Rotate, {a[0], axis, angle(call, std::array{y, a[1]})});
}

// Colours. Hue, saturation and lightness as in CSS, all within [0, 1]; colours are taken to be within [0, 1] too.
struct Channels {
  NodeId x, y, z;
};
Channels channels(Builder& b, NodeId color) {
  return {b.g.component(color, 0), b.g.component(color, 1), b.g.component(color, 2)};
}
NodeId vector_of(Builder& b, Channels c) { return b.g.make_vector(c.x, c.y, c.z); }

Channels hsl_of(Builder& b, NodeId color) {
  const auto [red, green, blue] = channels(b, b.unit_clamp(color));
  const NodeId most = b.max(b.max(red, green), blue), least = b.min(b.min(red, green), blue);
  const NodeId range = b.sub(most, least), lightness = b.mul(b.add(most, least), b.number(0.5));
  // Quotients by 0 are 0: greys have neither hue nor saturation.
  auto sector = [&](NodeId p, NodeId q, double start) { return b.add(b.div(b.sub(p, q), range), b.number(start)); };
  const NodeId sextant =
      b.select(b.equal(range, b.number(0)), b.number(0),
               b.select(b.equal(most, red), sector(green, blue, 6),
                        b.select(b.equal(most, green), sector(blue, red, 2), sector(red, green, 4))));
  const NodeId hue = b.g.make(Op::Mod, {b.mul(sextant, b.number(1.0 / 6)), b.number(1)});
  const NodeId widest = b.sub(b.number(1), b.unary(Op::Abs, b.sub(b.mul(b.number(2), lightness), b.number(1))));
  return {hue, b.unit_clamp(b.div(range, widest)), lightness};
}
NodeId rgb_of(Builder& b, Channels hsl) {
  const NodeId lightness = b.unit_clamp(hsl.z), one = b.number(1);
  const NodeId reach = b.mul(b.unit_clamp(hsl.y), b.min(lightness, b.sub(one, lightness)));
  auto channel = [&](double turn) {  // a trapezium of the hue
    const NodeId k = b.g.make(Op::Mod, {b.add(b.mul(hsl.x, b.number(12)), b.number(turn)), b.number(12)});
    const NodeId ramp = b.min(b.sub(k, b.number(3)), b.sub(b.number(9), k));
    return b.sub(lightness, b.mul(reach, b.clamp(ramp, b.number(-1), one)));
  };
  return b.g.make_vector(channel(0), channel(8), channel(4));
}
NodeId rgbtohsl(CallContext& call, Arguments a) {
  Builder b(call);
  return vector_of(b, hsl_of(b, a[0]));
}
NodeId hsltorgb(CallContext& call, Arguments a) {
  Builder b(call);
  return rgb_of(b, channels(b, a[0]));
}
// color, hue in degrees, saturation, intensity, map
NodeId hsi(CallContext& call, Arguments a) {
  Builder b(call);
  const NodeId map = b.argument_or(a, 4, 1), one = b.number(1);
  Channels c = hsl_of(b, a[0]);
  c.x = b.add(c.x, b.mul(b.mul(a[1], map), b.number(1.0 / 360)));
  c.y = b.mul(c.y, b.mix(one, a[2], map));
  return b.mul(rgb_of(b, c), b.mix(one, a[3], map));
}
NodeId saturate(CallContext& call, Arguments a) {
  Builder b(call);
  const NodeId rec709 = b.g.make_vector(b.number(0.2126), b.number(0.7152), b.number(0.0722));
  return b.max(b.mix(b.g.make(Op::Dot, {a[0], rec709}), a[0], a[1]), b.number(0));
}

// The place of a noise: one vector, or up to three scalars.
NodeId place_of(Builder& b, Arguments a) {
  if (b.g.is_vector(a[0])) {
    if (a.size() > 1) b.call.fail(1, "a noise at a vector takes no further argument");
    return a[0];
  }
  for (std::size_t i = 1; i < a.size(); ++i)
    if (b.g.is_vector(a[i])) b.call.fail(i, "a noise takes one vector, or one to three scalars");
  return b.g.make_vector(a[0], b.argument_or(a, 1, 0), b.argument_or(a, 2, 0));
}
NodeId half_and_half(Builder& b, NodeId a) { return b.add(b.mul(a, b.number(0.5)), b.number(0.5)); }

template <Op op>
NodeId at_place(CallContext& call, Arguments a) {
  Builder b(call);
  return b.unary(op, place_of(b, a));
}
template <Op op>
NodeId at_place_unsigned(CallContext& call, Arguments a) {
  Builder b(call);
  return half_and_half(b, b.unary(op, place_of(b, a)));
}

// Arguments from `first` on: octaves, lacunarity, gain.
NodeId octaves(Builder& b, Op op, NodeId place, Arguments a, std::size_t first, int default_octaves) {
  const int count = b.integer(a, first, default_octaves, 1, max_octaves, "the number of octaves");
  return b.g.make(op, {place, b.argument_or(a, first + 1, 2), b.argument_or(a, first + 2, 0.5)}, count);
}
template <Op op>
NodeId fractal(CallContext& call, Arguments a) {
  Builder b(call);
  return octaves(b, op, a[0], a, 1, 6);
}
NodeId cfbm(CallContext& call, Arguments a) {
  Builder b(call);
  return half_and_half(b, octaves(b, Op::VectorFbm, a[0], a, 1, 6));
}

// v, type, jitter, fbmScale, fbmOctaves, fbmLacunarity, fbmGain
template <Op op>
NodeId voronoi(CallContext& call, Arguments a) {
  Builder b(call);
  const int type = b.integer(a, 1, 1, 1, 5, "the type of voronoi");
  NodeId place = a[0];
  if (a.size() > 3) place = b.add(place, b.mul(a[3], octaves(b, Op::VectorFbm, place, a, 4, 4)));
  return b.g.make(op, {place, b.argument_or(a, 2, 0.5)}, op == Op::Voronoi ? type : 0);
}

NodeId hash(CallContext& call, Arguments a) {
  std::vector<NodeId> parts;
  for (NodeId n : a)
    for (int c = 0; c < (call.graph().is_vector(n) ? 3 : 1); ++c)
      parts.push_back(call.graph().is_vector(n) ? call.graph().component(n, c) : n);
  return call.graph().make(Op::Hash, parts);
}
NodeId rand(CallContext& call, Arguments a) {
  Builder b(call);
  const NodeId uniform = b.g.make(Op::Rand, {b.argument_or(a, 2, 0)}, call.next_occurrence());
  if (a.empty()) return uniform;
  return b.mix(a[0], b.argument_or(a, 1, 1), uniform);
}

// values[i] where position lies in [i, i + 1); the last from there on.
NodeId pick_by_index(Builder& b, NodeId position, Arguments values) {
  NodeId result = values[values.size() - 1];
  for (std::size_t i = values.size() - 1; i-- > 0;)
    result = b.select(b.less(position, b.number(double(i + 1))), values[i], result);
  return result;
}
void want_equal_types(Builder& b, Arguments a, std::size_t first, std::size_t stride) {
  for (std::size_t i = first; i < a.size(); i += stride)
    if (b.g.is_vector(a[i]) != b.g.is_vector(a[first])) b.call.fail(i, "all choices must be scalars or all vectors");
}
NodeId choose(CallContext& call, Arguments a) {
  Builder b(call);
  want_equal_types(b, a, 1, 1);
  return pick_by_index(b, b.mul(a[0], b.number(double(a.size() - 1))), a.subspan(1));
}
NodeId wchoose(CallContext& call, Arguments a) {
  Builder b(call);
  want_equal_types(b, a, 1, 2);
  NodeId total = b.number(0);
  std::vector<NodeId> ends;
  for (std::size_t i = 2; i < a.size(); i += 2) ends.push_back(total = b.add(total, b.max(a[i], b.number(0))));
  const NodeId position = b.mul(a[0], total);
  NodeId result = a[a.size() - 2];
  for (std::size_t i = ends.size() - 1; i-- > 0;) result = b.select(b.less(position, ends[i]), a[1 + 2 * i], result);
  return result;
}
// The whole number of [lower, upper] at an index that wraps.
NodeId cycle(CallContext& call, Arguments a) {
  Builder b(call);
  const NodeId lower = b.unary(Op::Floor, a[1]), upper = b.unary(Op::Floor, a[2]);
  const NodeId count = b.add(b.sub(upper, lower), b.number(1));
  return b.add(lower, b.g.make(Op::Mod, {b.unary(Op::Floor, a[0]), count}));
}
NodeId pick(CallContext& call, Arguments a) {
  Builder b(call);
  const NodeId lower = b.unary(Op::Floor, a[1]), upper = b.unary(Op::Floor, a[2]);
  const NodeId count = b.add(b.sub(upper, lower), b.number(1));
  return b.clamp(b.add(lower, b.unary(Op::Floor, b.mul(a[0], count))), lower, upper);
}

// A control point of a curve: what holds from it to the next one.
struct ControlPoint {
  double position, value;
  int interpolation;  // 0 none, 1 linear, 2 smooth, 3 spline, 4 monotone spline
  double slope = 0;
};

void set_slopes(std::vector<ControlPoint>& p) {
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const double width = p[i + 1].position - p[i - 1].position;
    p[i].slope = width > 0 ? (p[i + 1].value - p[i - 1].value) / width : 0;
  }
  // Fritsch and Carlson 1980: slopes of at most three times the secant keep a piece monotone
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    if (p[i].interpolation != 4) continue;
    const double width = p[i + 1].position - p[i].position;
    const double secant = width > 0 ? (p[i + 1].value - p[i].value) / width : 0;
    for (double* slope : {&p[i].slope, &p[i + 1].slope})
      *slope = secant == 0 ? 0 : std::clamp(*slope / secant, 0.0, 3.0) * secant;
  }
}

CurvePiece piece_between(const ControlPoint& a, const ControlPoint& b) {
  const double h = b.position - a.position, rise = b.value - a.value;
  auto piece = [&](double c1, double c2, double c3) {
    auto number = [](double v) {
      return float(
          std::clamp(v, -double(std::numeric_limits<float>::max()), double(std::numeric_limits<float>::max())));
    };
    return CurvePiece{float(a.position), float(a.value), number(c1), number(c2), number(c3)};
  };
  if (h <= 0 || a.interpolation == 0) return piece(0, 0, 0);
  if (a.interpolation == 1) return piece(rise / h, 0, 0);
  if (a.interpolation == 2) return piece(0, 3 * rise / (h * h), -2 * rise / (h * h * h));
  return piece(a.slope, (3 * rise / h - 2 * a.slope - b.slope) / h, (a.slope + b.slope - 2 * rise / h) / (h * h));
}

CurveTable curve_through(std::vector<ControlPoint> points) {
  std::ranges::stable_sort(points, {}, &ControlPoint::position);
  set_slopes(points);
  CurveTable table;
  const float lowest = std::numeric_limits<float>::lowest();
  table.pieces.push_back({lowest, float(points.front().value), 0, 0, 0});
  for (std::size_t i = 0; i + 1 < points.size(); ++i) table.pieces.push_back(piece_between(points[i], points[i + 1]));
  table.pieces.push_back({float(points.back().position), float(points.back().value), 0, 0, 0});
  return table;
}

CurveTable curve_of(Builder& b, Arguments a, int component) {
  std::vector<ControlPoint> points;
  for (std::size_t i = 1; i + 2 < a.size(); i += 3)
    points.push_back({b.g.constant_value(a[i]).x, b.g.constant_value(a[i + 1])[component],
                      b.integer(a, i + 2, 1, 0, 4, "the interpolation of a curve")});
  return curve_through(std::move(points));
}
NodeId curve(CallContext& call, Arguments a) {
  Builder b(call);
  return b.g.curve(a[0], curve_of(b, a, 0));
}
NodeId ccurve(CallContext& call, Arguments a) {
  Builder b(call);
  std::array<NodeId, 3> parts{};
  for (int c = 0; c < 3; ++c) parts[std::size_t(c)] = b.g.curve(a[0], curve_of(b, a, c));
  return b.g.make_vector(parts[0], parts[1], parts[2]);
}

template <Op op>
NodeId grid_at(CallContext& call, Arguments a) {
  return call.graph().grid(op, a[1], call.grid(0, 2));
}

constexpr Builtin builtins[] = {
    {{"abs", "numbers", "abs(x)", "x without its sign"}, "c", direct<Op::Abs>},
    {{"sign", "numbers", "sign(x)", "-1, 0 or 1"}, "c", direct<Op::Sign>},
    {{"floor", "numbers", "floor(x)", "the largest whole number not above x"}, "c", direct<Op::Floor>},
    {{"ceil", "numbers", "ceil(x)", "the smallest whole number not below x"}, "c", direct<Op::Ceil>},
    {{"round", "numbers", "round(x)", "floor(x + 0.5)"}, "c", direct<Op::Round>},
    {{"trunc", "numbers", "trunc(x)", "x without its fraction"}, "c", direct<Op::Trunc>},
    {{"fmod", "numbers", "fmod(x, y)", "the remainder of x / y with the sign of x; 0 if y is 0"},
     "cc",
     direct<Op::Fmod>},
    {{"min", "numbers", "min(a, b, ...)", "the smallest"}, "c*c", fold_all<Op::Min>},
    {{"max", "numbers", "max(a, b, ...)", "the largest"}, "c*c", fold_all<Op::Max>},
    {{"clamp", "numbers", "clamp(x, lo, hi)", "min(max(x, lo), hi)"}, "ccc", clamp},
    {{"sqrt", "numbers", "sqrt(x)", "the square root of max(x, 0)"}, "c", direct<Op::Sqrt>},
    {{"cbrt", "numbers", "cbrt(x)", "the cube root, with the sign of x"}, "c", direct<Op::Cbrt>},
    {{"pow", "numbers", "pow(x, y)", "x^y; 0 where it is not real, and for 0 to a negative power"},
     "cc",
     direct<Op::Pow>},
    {{"exp", "numbers", "exp(x)", "E^x"}, "c", direct<Op::Exp>},
    {{"log", "numbers", "log(x)", "the natural logarithm of max(x, 2^-126)"}, "c", direct<Op::Log>},
    {{"log10", "numbers", "log10(x)", "the decimal logarithm of max(x, 2^-126)"}, "c", direct<Op::Log10>},
    {{"hypot", "numbers", "hypot(x, y)", "sqrt(x*x + y*y)"}, "ss", hypot},
    {{"invert", "numbers", "invert(x)", "1 - x, as ~x"}, "c", invert},

    {{"sin", "angles", "sin(x)", "sine of an angle in radians"}, "c", direct<Op::Sin>},
    {{"cos", "angles", "cos(x)", "cosine of an angle in radians"}, "c", direct<Op::Cos>},
    {{"tan", "angles", "tan(x)", "tangent of an angle in radians"}, "c", direct<Op::Tan>},
    {{"asin", "angles", "asin(x)", "arc sine of clamp(x, -1, 1), in radians"}, "c", direct<Op::Asin>},
    {{"acos", "angles", "acos(x)", "arc cosine of clamp(x, -1, 1), in radians"}, "c", direct<Op::Acos>},
    {{"atan", "angles", "atan(x)", "arc tangent in radians"}, "c", direct<Op::Atan>},
    {{"atan2", "angles", "atan2(y, x)", "the angle of the point (x, y) in radians; 0 at the origin"},
     "cc",
     direct<Op::Atan2>},
    {{"sinh", "angles", "sinh(x)", "hyperbolic sine"}, "c", direct<Op::Sinh>},
    {{"cosh", "angles", "cosh(x)", "hyperbolic cosine"}, "c", direct<Op::Cosh>},
    {{"tanh", "angles", "tanh(x)", "hyperbolic tangent"}, "c", direct<Op::Tanh>},
    {{"deg", "angles", "deg(x)", "radians to degrees"}, "c", deg},
    {{"rad", "angles", "rad(x)", "degrees to radians"}, "c", rad},
    {{"sind", "angles", "sind(x)", "sin(rad(x))"}, "c", of_degrees<Op::Sin>},
    {{"cosd", "angles", "cosd(x)", "cos(rad(x))"}, "c", of_degrees<Op::Cos>},
    {{"tand", "angles", "tand(x)", "tan(rad(x))"}, "c", of_degrees<Op::Tan>},
    {{"asind", "angles", "asind(x)", "deg(asin(x))"}, "c", in_degrees<Op::Asin>},
    {{"acosd", "angles", "acosd(x)", "deg(acos(x))"}, "c", in_degrees<Op::Acos>},
    {{"atand", "angles", "atand(x)", "deg(atan(x))"}, "c", in_degrees<Op::Atan>},
    {{"atan2d", "angles", "atan2d(y, x)", "deg(atan2(y, x))"}, "cc", in_degrees<Op::Atan2>},

    {{"mix", "ramps", "mix(a, b, t)", "a*(1 - t) + b*t"}, "ccc", direct<Op::Mix>},
    {{"compress", "ramps", "compress(x, lo, hi)", "mix(lo, hi, x): from [0, 1] to [lo, hi]"}, "ccc", compress},
    {{"expand", "ramps", "expand(x, lo, hi)",
      "(x - lo) / (hi - lo): from [lo, hi] to [0, 1]; boxstep(x, lo) if they are equal"},
     "ccc",
     expand},
    {{"fit", "ramps", "fit(x, a1, b1, a2, b2)", "mix(a2, b2, expand(x, a1, b1))"}, "ccccc", fit},
    {{"boxstep", "ramps", "boxstep(x, a)", "0 below a, else 1"}, "cc", boxstep},
    {{"linearstep", "ramps", "linearstep(x, a, b)", "t = clamp(expand(x, a, b), 0, 1)"}, "ccc", linearstep},
    {{"smoothstep", "ramps", "smoothstep(x, a, b)", "t*t*(3 - 2*t) of the t of linearstep"}, "ccc", smoothstep},
    {{"gaussstep", "ramps", "gaussstep(x, a, b)", "0 where the t of linearstep is 0, else 2^(-8*(1 - t)^2)"},
     "ccc",
     gaussstep},
    {{"remap", "ramps", "remap(x, source, range, falloff, interp)",
      "1 within range of source, 0 beyond range + falloff; between them linear (interp 0), smooth (1) or gaussian (2)"},
     "ccccc",
     remap},
    {{"gamma", "ramps", "gamma(x, g)", "pow(x, 1/g)"}, "cc", gamma},
    {{"bias", "ramps", "bias(x, b)", "pow(x, log(b)/log(0.5)): 0.5 becomes b"}, "cc", bias},
    {{"contrast", "ramps", "contrast(x, c)", "bias of both halves: less contrast below c = 0.5, more above"},
     "cc",
     contrast},

    {{"length", "vectors", "length(v)", "Euclidean length"}, "v", direct<Op::Length>},
    {{"norm", "vectors", "norm(v)", "v / length(v); zero for the zero vector"}, "v", direct<Op::Norm>},
    {{"dot", "vectors", "dot(a, b)", "scalar product"}, "vv", direct<Op::Dot>},
    {{"cross", "vectors", "cross(a, b)", "vector product"}, "vv", direct<Op::Cross>},
    {{"dist", "vectors", "dist(a, b)", "length(a - b)"}, "vv", dist},
    {{"angle", "vectors", "angle(a, b)", "angle between two vectors, in radians"}, "vv", angle},
    {{"ortho", "vectors", "ortho(a, b)", "norm(cross(a, b))"}, "vv", ortho},
    {{"rotate", "vectors", "rotate(v, axis, angle)",
      "v turned about axis by an angle in radians, counter-clockwise seen against the axis"},
     "vvs",
     direct<Op::Rotate>},
    {{"up", "vectors", "up(v, to)", "v turned by the rotation that takes [0,1,0] to the direction of `to`"}, "vv", up},

    {{"saturate", "colours", "saturate(color, amount)",
      "0: grey of the colour's luminance, 1: the colour, beyond: more of it; not below 0"},
     "vs",
     saturate},
    {{"hsi", "colours", "hsi(color, hue, saturation, intensity, map=1)",
      "hue turned by degrees, saturation and intensity multiplied; where map is 0 nothing changes"},
     "vsss;s",
     hsi},
    {{"rgbtohsl", "colours", "rgbtohsl(color)", "hue, saturation and lightness, each in [0, 1], of clamp(color, 0, 1)"},
     "v",
     rgbtohsl},
    {{"hsltorgb", "colours", "hsltorgb(hsl)", "the colour of hue (1 is a turn), saturation and lightness"},
     "v",
     hsltorgb},

    {{"noise", "noise", "noise(v)", "0.5*snoise(v) + 0.5, in [0, 1]; also noise(x), noise(x, y), noise(x, y, z)"},
     "c;cc",
     at_place_unsigned<Op::Noise>},
    {{"snoise", "noise", "snoise(v)", "gradient noise in [-1, 1]; scalars as for noise"}, "c;cc", at_place<Op::Noise>},
    {{"vnoise", "noise", "vnoise(v)", "three gradient noises, the first of them snoise(v)"},
     "c;cc",
     at_place<Op::VectorNoise>},
    {{"cnoise", "noise", "cnoise(v)", "0.5*vnoise(v) + 0.5"}, "c;cc", at_place_unsigned<Op::VectorNoise>},
    {{"fbm", "noise", "fbm(v, octaves=6, lacunarity=2, gain=0.5)",
      "sum of snoise over octaves, within the sum of |gain|^k"},
     "v;kss",
     fractal<Op::Fbm>},
    {{"vfbm", "noise", "vfbm(v, octaves=6, lacunarity=2, gain=0.5)", "three such sums, the first of them fbm"},
     "v;kss",
     fractal<Op::VectorFbm>},
    {{"cfbm", "noise", "cfbm(v, octaves=6, lacunarity=2, gain=0.5)", "0.5*vfbm(...) + 0.5"}, "v;kss", cfbm},
    {{"turbulence", "noise", "turbulence(v, octaves=6, lacunarity=2, gain=0.5)", "sum of abs(snoise) over octaves"},
     "v;kss",
     fractal<Op::Turbulence>},
    {{"vturbulence", "noise", "vturbulence(v, octaves=6, lacunarity=2, gain=0.5)",
      "three such sums, the first of them turbulence"},
     "v;kss",
     fractal<Op::VectorTurbulence>},
    {{"cellnoise", "noise", "cellnoise(v)", "one random number in [0, 1) a unit cell; scalars as for noise"},
     "c;cc",
     at_place<Op::CellNoise>},
    {{"ccellnoise", "noise", "ccellnoise(v)", "three random numbers a unit cell"}, "c;cc", at_place<Op::CellColor>},
    {{"voronoi", "noise", "voronoi(v, type=1, jitter=0.5, fbmScale=0, fbmOctaves=4, fbmLacunarity=2, fbmGain=0.5)",
      "distances to jittered points: nearest (1), second (2), their difference (3), cell borders (4), their mean (5)"},
     "v;ksskss",
     voronoi<Op::Voronoi>},
    {{"cvoronoi", "noise", "cvoronoi(v, type=1, jitter=0.5, fbmScale=0, fbmOctaves=4, fbmLacunarity=2, fbmGain=0.5)",
      "three random numbers of the nearest point"},
     "v;ksskss",
     voronoi<Op::VoronoiColor>},
    {{"pvoronoi", "noise", "pvoronoi(v, type=1, jitter=0.5, fbmScale=0, fbmOctaves=4, fbmLacunarity=2, fbmGain=0.5)",
      "the place of the nearest point"},
     "v;ksskss",
     voronoi<Op::VoronoiPosition>},

    {{"hash", "chance", "hash(a, ...)", "a random number in [0, 1) that depends on the arguments alone"}, "*c", hash},
    {{"rand", "chance", "rand(min=0, max=1, seed=0)",
      "a random number of this vertex or face, another one for each rand in the text"},
     ";sss",
     rand},
    {{"choose", "chance", "choose(index, a, b, ...)", "index in [0, 1) chooses with equal shares"}, "sc*c", choose},
    {{"wchoose", "chance", "wchoose(index, a, weight, ...)", "index in [0, 1) chooses with shares by weight"},
     "s*cs",
     wchoose},
    {{"pick", "chance", "pick(index, lo, hi)", "index in [0, 1) chooses a whole number from lo to hi"}, "sss", pick},
    {{"cycle", "chance", "cycle(index, lo, hi)", "lo to hi and around again as index counts up"}, "sss", cycle},

    {{"curve", "curves", "curve(x, pos, value, interp, ...)",
      "through constant points; interp 0 none, 1 linear, 2 smooth, 3 spline, 4 monotone spline"},
     "s*kkk",
     curve},
    {{"ccurve", "curves", "ccurve(x, pos, color, interp, ...)", "a curve of vectors"}, "s*kmk", ccurve},
    {{"spline", "curves", "spline(x, y1, y2, y3, y4, ...)",
      "Catmull-Rom from y2 at x = 0 to the last but one at x = 1"},
     "ssss*s",
     direct<Op::Spline>},

    {{"vdb", "grids", "vdb('name', v, 'grid')",
      "the value at v of an OpenVDB file beside the scene ('rock.vdb'), or of one of the scene's grids by its name"},
     "tv;t",
     grid_at<Op::GridValue>},
    {{"vdb_gradient", "grids", "vdb_gradient('name', v, 'grid')",
      "how that value rises along x, y and z; of a level set the direction away from the surface"},
     "tv;t",
     grid_at<Op::GridGradient>},
};

}  // namespace

const Builtin* find_builtin(std::string_view name) {
  const auto* found = std::ranges::find(builtins, name, [](const Builtin& b) { return b.info.name; });
  return found == std::end(builtins) ? nullptr : found;
}

const std::vector<std::string>& builtin_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Builtin& b : builtins) list.emplace_back(b.info.name);
    return list;
  }();
  return names;
}

std::span<const FunctionInfo> expression_functions() {
  static const std::vector<FunctionInfo> infos = [] {
    std::vector<FunctionInfo> list;
    for (const Builtin& b : builtins) list.push_back(b.info);
    return list;
  }();
  return infos;
}

}  // namespace meristem
