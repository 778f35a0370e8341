#include "geometry/fields/noise_bounds.h"

#include "geometry/fields/kernels.h"
#include "geometry/fields/noise_constants.h"

namespace meristem {

using namespace bounds;

bool has_octaves(Op op) {
  switch (op) {
    case Op::Fbm:
    case Op::VectorFbm:
    case Op::Turbulence:
    case Op::VectorTurbulence:
    case Op::Fbm4:
    case Op::VectorFbm4: return true;
    default: return false;
  }
}

int noise_dimensions(Op op) {
  switch (op) {
    case Op::Noise4:
    case Op::VectorNoise4:
    case Op::Fbm4:
    case Op::VectorFbm4: return 4;
    default: return 3;
  }
}

namespace {

using Place = std::array<double, 4>;

double largest_magnitude(const Place& p) {
  double largest = 0;
  for (double v : p) largest = std::max(largest, std::abs(v));
  return largest;
}

// The noise of which an operation sums octaves.
Op single_noise(Op op) {
  switch (op) {
    case Op::Fbm:
    case Op::Turbulence: return Op::Noise;
    case Op::VectorFbm:
    case Op::VectorTurbulence: return Op::VectorNoise;
    case Op::Fbm4: return Op::Noise4;
    case Op::VectorFbm4: return Op::VectorNoise4;
    default: return op;
  }
}

// The points that an octave sees: a centre, and a radius that holds the rounding of the kernel's own steps.
struct Ball {
  Place center{};
  double radius = 0;

  static Ball around(const std::array<Range, 4>& box) {
    Ball ball;
    double squares = 0;
    for (std::size_t c = 0; c < 4; ++c) {
      const Range r = clipped(box[c], -0x1p24, 0x1p24);
      const double half = (r.upper - r.lower) / 2;
      ball.center[c] = (r.lower + r.upper) / 2;
      squares += half * half;
    }
    ball.radius = std::sqrt(squares) * (1 + 0x1p-50);
    return ball;
  }
  double size() const { return largest_magnitude(center); }
  void step(double lacunarity, double shift, int dimensions) {
    const Place p{center[0] * lacunarity, center[1] * lacunarity, center[2] * lacunarity, center[3] * lacunarity};
    const double t = (p[1] + p[2] - p[0]) * (2.0 / 3) + shift;
    center = {t - p[1], t - p[2], t + p[0], dimensions == 4 ? p[3] + shift : 0};
    radius = radius * std::abs(lacunarity) * (1 + 0x1p-20) + (size() + largest_magnitude(p) + 1) * 0x1p-20;
  }
};

class NoiseBounds {
 public:
  explicit NoiseBounds(const NoisePlaces& places)
      : places_(places), single_(single_noise(places.op)), dimensions_(noise_dimensions(places.op)) {}

  Box run() const {
    const bool absolute_value = places_.op == Op::Turbulence || places_.op == Op::VectorTurbulence;
    const bool single = !has_octaves(places_.op);
    const Range lacunarity = clipped(places_.lacunarity, -double(max_lacunarity), max_lacunarity);
    const Range gain = single ? Range{} : clipped(places_.gain, -double(max_gain), max_gain);
    Box sum{};
    Range amplitude{1, 1};
    double magnitude = 0;
    Ball ball = Ball::around(places_.place);
    for (int k = 0; k < (single ? 1 : places_.octaves); ++k) {
      const Box here = noise_in(ball);
      for (std::size_t c = 0; c < 3; ++c)
        sum[c] = add(sum[c], multiply(amplitude, absolute_value ? absolute(here[c]) : here[c]));
      magnitude += amplitude.magnitude();
      amplitude = multiply(amplitude, gain);
      if (lacunarity.lower == lacunarity.upper)
        ball.step(lacunarity.lower, octave_shifts[std::size_t(k)], dimensions_);
      else
        ball.radius = infinity;
    }
    for (Range& r : sum) {
      r = rounded({r.lower - magnitude * 1e-5, r.upper + magnitude * 1e-5});
      r = clipped(r, -magnitude * 1.00001, magnitude * 1.00001);
      if (absolute_value && gain.lower >= 0) r.lower = std::max(r.lower, 0.0);
    }
    return sum;
  }

 private:
  Box noise_in(const Ball& ball) const {
    const Range all{-1, 1};
    const double slope = dimensions_ == 4 ? noise_slope_4d : noise_slope;
    const double reach = slope * (ball.radius + ball.size() * 0x1p-22) + 1e-5;
    if (!(reach < 2) || !has_one_period()) return {all, all, all};
    const Vec3f value = noise_at(ball.center);
    Box box;
    for (int c = 0; c < 3; ++c)
      box[std::size_t(c)] = clipped(Range{double(value[c]) - reach, double(value[c]) + reach}, all);
    return box;
  }

  // Noises of other periods have nothing to do with each other.
  bool has_one_period() const {
    const auto period = [](double v) { return std::max(std::trunc(v), 1.0); };
    return single_ != Op::PeriodicNoise ||
           std::ranges::all_of(places_.period, [&](const Range& r) { return period(r.lower) == period(r.upper); });
  }

  Vec3f noise_at(const Place& p) const {
    std::array<std::array<float, lane_group>, 6> place{};
    std::array<std::array<float, lane_group>, 3> out{};
    std::array<Operand, 6> operands;
    const std::size_t count = single_ == Op::PeriodicNoise ? 6 : std::size_t(dimensions_);
    for (std::size_t c = 0; c < count; ++c) {
      const bool is_period = single_ == Op::PeriodicNoise && c >= 3;
      place[c].fill(float(is_period ? places_.period[c - 3].lower : p[c]));
      operands[c] = {place[c].data(), 0};
    }
    const KernelCall call{{out[0].data(), out[1].data(), out[2].data()}, operands.data(), int(count)};
    best_kernels().functions[std::size_t(single_)](call, lane_group);
    return {out[0][0], out[1][0], out[2][0]};
  }

  const NoisePlaces& places_;
  const Op single_;
  const int dimensions_;
};

}  // namespace

bounds::Box noise_bounds(const NoisePlaces& places) { return NoiseBounds(places).run(); }

}  // namespace meristem
