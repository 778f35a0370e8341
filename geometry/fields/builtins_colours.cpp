#include "geometry/fields/builder.h"

namespace meristem {

namespace {

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
// color, hue in degrees, saturation, intensity, map, falloff, interpolation: hsi both ways, by m in [-1, 1]
NodeId midhsi(CallContext& call, Arguments a) {
  Builder b(call);
  const NodeId zero = b.number(0), one = b.number(1);
  const NodeId centered = b.sub(b.mul(a[4], b.number(2)), one);
  const NodeId strength =
      remap_of(b, b.unary(Op::Abs, centered), one, zero, b.argument_or(a, 5, 1), b.argument_or(a, 6, 0));
  const NodeId is_back = b.less(centered, zero);
  auto factor = [&](NodeId full) {
    const NodeId forth = b.mix(one, full, strength);
    return b.select(is_back, b.div(one, forth), forth);
  };
  const NodeId turn = b.mul(b.mul(a[1], strength), b.number(1.0 / 360));
  Channels c = hsl_of(b, a[0]);
  c.x = b.add(c.x, b.select(is_back, b.sub(zero, turn), turn));
  c.y = b.mul(c.y, factor(a[2]));
  return b.mul(rgb_of(b, c), factor(a[3]));
}
NodeId saturate(CallContext& call, Arguments a) {
  Builder b(call);
  const NodeId rec709 = b.g.make_vector(b.number(0.2126), b.number(0.7152), b.number(0.0722));
  return b.max(b.mix(b.g.make(Op::Dot, {a[0], rec709}), a[0], a[1]), b.number(0));
}

constexpr Builtin builtins[] = {
    {{"saturate", "colours", "saturate(color, amount)",
      "0: grey of the colour's luminance, 1: the colour, beyond: more of it; not below 0"},
     "vs",
     saturate},
    {{"hsi", "colours", "hsi(color, hue, saturation, intensity, map=1)",
      "hue turned by degrees, saturation and intensity multiplied; where map is 0 nothing changes"},
     "vsss;s",
     hsi},
    {{"midhsi", "colours", "midhsi(color, hue, saturation, intensity, map, falloff=1, interp=0)",
      "hsi both ways: nothing where map is 0.5, all of it at 1, its inverse at 0; abs(2*map - 1) goes through remap(_, "
      "1, 0, falloff, interp)"},
     "vssss;ss",
     midhsi},
    {{"rgbtohsl", "colours", "rgbtohsl(color)", "hue, saturation and lightness, each in [0, 1], of clamp(color, 0, 1)"},
     "v",
     rgbtohsl},
    {{"hsltorgb", "colours", "hsltorgb(hsl)", "the colour of hue (1 is a turn), saturation and lightness"},
     "v",
     hsltorgb},
};

}  // namespace

std::span<const Builtin> colour_builtins() { return builtins; }

}  // namespace meristem
