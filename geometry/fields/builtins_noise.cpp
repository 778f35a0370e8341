#include "geometry/fields/builder.h"
#include "geometry/fields/noise_constants.h"

#include <algorithm>
#include <vector>

namespace meristem {

namespace {

// The place of a noise: a vector, or one to three scalars.
NodeId place_of(Builder& b, Arguments a) {
  if (b.g.is_vector(a[0])) return a[0];
  return b.g.make_vector(a[0], b.argument_or(a, 1, 0), b.argument_or(a, 2, 0));
}
void want_scalars(Builder& b, Arguments a, std::size_t from, const char* message) {
  for (std::size_t i = from; i < a.size(); ++i)
    if (b.g.is_vector(a[i])) b.call.fail(i, message);
}
// A noise of the three dimensions of a place, or with another scalar after it of four.
NodeId noise_of(Builder& b, Op op, Op op_4d, Arguments a) {
  const bool is_vector = b.g.is_vector(a[0]);
  if (is_vector && a.size() > 2) b.call.fail(2, "a noise at a vector takes one scalar more, a time, and nothing else");
  want_scalars(b, a, 1, "a noise takes one vector, a vector and a scalar, or one to four scalars");
  const std::size_t time = is_vector ? 1 : 3;
  const NodeId place = place_of(b, a.first(std::min(time, a.size())));
  return a.size() > time ? b.g.make(op_4d, {place, a[time]}) : b.unary(op, place);
}
NodeId half_and_half(Builder& b, NodeId a) { return b.add(b.mul(a, b.number(0.5)), b.number(0.5)); }

template <Op op, Op op_4d>
NodeId noise(CallContext& call, Arguments a) {
  Builder b(call);
  return noise_of(b, op, op_4d, a);
}
template <Op op, Op op_4d>
NodeId unsigned_noise(CallContext& call, Arguments a) {
  Builder b(call);
  return half_and_half(b, noise_of(b, op, op_4d, a));
}
NodeId pnoise(CallContext& call, Arguments a) { return call.graph().make(Op::PeriodicNoise, a); }

template <Op op>
NodeId at_cell(CallContext& call, Arguments a) {
  Builder b(call);
  if (b.g.is_vector(a[0]) && a.size() > 1) b.call.fail(1, "a cell noise at a vector takes no further argument");
  want_scalars(b, a, 1, "a cell noise takes one vector, or one to three scalars");
  return b.unary(op, place_of(b, a));
}

// Octaves, lacunarity and gain stand in the arguments from `first` on; `place` is what comes before them.
NodeId octaves(Builder& b, Op op, Arguments place, Arguments a, std::size_t first, int default_octaves) {
  const int count = b.integer(a, first, default_octaves, 1, max_octaves, "the number of octaves");
  std::vector<NodeId> all(place.begin(), place.end());
  all.push_back(b.argument_or(a, first + 1, 2));
  all.push_back(b.argument_or(a, first + 2, 0.5));
  return b.g.make(op, all, count);
}
// `dimensions` 3: v, then the octaves' arguments; 4: v and a time before them.
template <Op op, int dimensions>
NodeId fractal(CallContext& call, Arguments a) {
  Builder b(call);
  constexpr std::size_t first = dimensions - 2;
  return octaves(b, op, a.first(first), a, first, 6);
}
template <Op op, int dimensions>
NodeId unsigned_fractal(CallContext& call, Arguments a) {
  Builder b(call);
  return half_and_half(b, fractal<op, dimensions>(call, a));
}

// v, type, jitter, fbmScale, fbmOctaves, fbmLacunarity, fbmGain
template <Op op>
NodeId voronoi(CallContext& call, Arguments a) {
  Builder b(call);
  const int type = b.integer(a, 1, 1, 1, 5, "the type of voronoi");
  NodeId place = a[0];
  if (a.size() > 3) place = b.add(place, b.mul(a[3], octaves(b, Op::VectorFbm, a.first(1), a, 4, 4)));
  return b.g.make(op, {place, b.argument_or(a, 2, 0.5)}, op == Op::Voronoi ? type : 0);
}

constexpr Builtin builtins[] = {
    {{"noise", "noise", "noise(v)",
      "0.5*snoise(v) + 0.5, in [0, 1]; also noise(x), noise(x, y), noise(x, y, z); in four dimensions noise(v, t), "
      "noise(x, y, z, t)"},
     "c;ccc",
     unsigned_noise<Op::Noise, Op::Noise4>},
    {{"snoise", "noise", "snoise(v)", "gradient noise in [-1, 1]; scalars and a fourth dimension as for noise"},
     "c;ccc",
     noise<Op::Noise, Op::Noise4>},
    {{"vnoise", "noise", "vnoise(v)", "three gradient noises, the first of them snoise(v)"},
     "c;ccc",
     noise<Op::VectorNoise, Op::VectorNoise4>},
    {{"cnoise", "noise", "cnoise(v)", "0.5*vnoise(v) + 0.5"},
     "c;ccc",
     unsigned_noise<Op::VectorNoise, Op::VectorNoise4>},
    {{"snoise4", "noise", "snoise4(v, t)", "snoise(v, t): four-dimensional; at t = 0 it is snoise(v)"},
     "vs",
     noise<Op::Noise, Op::Noise4>},
    {{"vnoise4", "noise", "vnoise4(v, t)", "vnoise(v, t)"}, "vs", noise<Op::VectorNoise, Op::VectorNoise4>},
    {{"cnoise4", "noise", "cnoise4(v, t)", "cnoise(v, t)"}, "vs", unsigned_noise<Op::VectorNoise, Op::VectorNoise4>},
    {{"pnoise", "noise", "pnoise(v, period)",
      "snoise that comes again every max(trunc(period), 1) along each axis; for v in [0, period - 1] it is snoise(v)"},
     "vv",
     pnoise},
    {{"fbm", "noise", "fbm(v, octaves=6, lacunarity=2, gain=0.5)",
      "sum of snoise over octaves, within the sum of |gain|^k"},
     "v;kss",
     fractal<Op::Fbm, 3>},
    {{"vfbm", "noise", "vfbm(v, octaves=6, lacunarity=2, gain=0.5)", "three such sums, the first of them fbm"},
     "v;kss",
     fractal<Op::VectorFbm, 3>},
    {{"cfbm", "noise", "cfbm(v, octaves=6, lacunarity=2, gain=0.5)", "0.5*vfbm(...) + 0.5"},
     "v;kss",
     unsigned_fractal<Op::VectorFbm, 3>},
    {{"fbm4", "noise", "fbm4(v, t, octaves=6, lacunarity=2, gain=0.5)",
      "sum of snoise4 over octaves: fbm that changes with t"},
     "vs;kss",
     fractal<Op::Fbm4, 4>},
    {{"vfbm4", "noise", "vfbm4(v, t, octaves=6, lacunarity=2, gain=0.5)", "three such sums, the first of them fbm4"},
     "vs;kss",
     fractal<Op::VectorFbm4, 4>},
    {{"cfbm4", "noise", "cfbm4(v, t, octaves=6, lacunarity=2, gain=0.5)", "0.5*vfbm4(...) + 0.5"},
     "vs;kss",
     unsigned_fractal<Op::VectorFbm4, 4>},
    {{"turbulence", "noise", "turbulence(v, octaves=6, lacunarity=2, gain=0.5)", "sum of abs(snoise) over octaves"},
     "v;kss",
     fractal<Op::Turbulence, 3>},
    {{"vturbulence", "noise", "vturbulence(v, octaves=6, lacunarity=2, gain=0.5)",
      "three such sums, the first of them turbulence"},
     "v;kss",
     fractal<Op::VectorTurbulence, 3>},
    {{"cturbulence", "noise", "cturbulence(v, octaves=6, lacunarity=2, gain=0.5)", "0.5*vturbulence(...) + 0.5"},
     "v;kss",
     unsigned_fractal<Op::VectorTurbulence, 3>},
    {{"cellnoise", "noise", "cellnoise(v)", "one random number in [0, 1) a unit cell; scalars as for noise"},
     "c;cc",
     at_cell<Op::CellNoise>},
    {{"ccellnoise", "noise", "ccellnoise(v)", "three random numbers a unit cell"}, "c;cc", at_cell<Op::CellColor>},
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
};

}  // namespace

std::span<const Builtin> noise_builtins() { return builtins; }

}  // namespace meristem
