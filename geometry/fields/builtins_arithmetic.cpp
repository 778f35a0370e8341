#include "geometry/fields/builder.h"

namespace meristem {

namespace {

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
  return remap_of(b, a[0], a[1], a[2], a[3], a[4]);
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
    {{"asinh", "angles", "asinh(x)", "inverse hyperbolic sine"}, "c", direct<Op::Asinh>},
    {{"acosh", "angles", "acosh(x)", "inverse hyperbolic cosine of max(x, 1)"}, "c", direct<Op::Acosh>},
    {{"atanh", "angles", "atanh(x)", "inverse hyperbolic tangent of clamp(x, -1 + 2^-24, 1 - 2^-24)"},
     "c",
     direct<Op::Atanh>},
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
};

}  // namespace

NodeId remap_of(Builder& b, NodeId x, NodeId source, NodeId range, NodeId falloff, NodeId interpolation) {
  range = b.unary(Op::Abs, range);
  falloff = b.unary(Op::Abs, falloff);
  const NodeId distance = b.unary(Op::Abs, b.sub(x, source));
  const NodeId place = b.div(b.sub(b.add(range, falloff), distance), falloff);
  const NodeId whole = b.unary(Op::Trunc, interpolation);
  const NodeId soft =
      b.select(b.equal(whole, b.number(0)), b.unit_clamp(place),
               b.select(b.equal(whole, b.number(1)), b.unary(Op::SmoothCurve, place), b.unary(Op::GaussCurve, place)));
  return b.select(b.equal(falloff, b.number(0)), b.less(distance, range), soft);
}

std::span<const Builtin> arithmetic_builtins() { return builtins; }

}  // namespace meristem
