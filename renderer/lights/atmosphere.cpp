#include "renderer/lights/atmosphere.h"

#include "geometry/base/parallel.h"

namespace meristem {
namespace {

// Kilometres, and per kilometre.
constexpr double ground = 6360, top = 6460;
constexpr double rayleigh_height = 8, mie_height = 1.2;
constexpr double ozone_center = 25, ozone_half_width = 15;
const Vec3d rayleigh_scattering{5.802e-3, 13.558e-3, 33.1e-3};
const Vec3d ozone_absorption{0.650e-3, 1.881e-3, 0.085e-3};
const Vec3d wavelengths{0.680, 0.550, 0.440};  // micrometres
constexpr double mie_albedo = 0.9;             // scattering / extinction of aerosols
constexpr double mie_asymmetry = 0.8;
constexpr double sun_radius = 0.004675;  // radians

// Where a ray from `radius` at the cosine `c` against the vertical leaves the sphere `outer` around it.
double distance_to_outer(double radius, double c, double outer) {
  return -radius * c + std::sqrt(std::max(0.0, radius * radius * (c * c - 1) + outer * outer));
}
bool meets_ground(double radius, double c) {
  return c < 0 && radius * radius * (c * c - 1) + ground * ground > 0 && radius > ground;
}
double distance_to_ground(double radius, double c) {
  return -radius * c - std::sqrt(std::max(0.0, radius * radius * (c * c - 1) + ground * ground));
}
double radius_along(double radius, double c, double t) {
  return std::clamp(std::sqrt(radius * radius + t * t + 2 * radius * c * t), ground, top);
}
Vec3d exp_of(Vec3d v) { return {std::exp(v.x), std::exp(v.y), std::exp(v.z)}; }

double rayleigh_phase(double c) { return 3 / (16 * pi) * (1 + c * c); }
// Cornette and Shanks 1992.
double mie_phase(double c) {
  const double g = mie_asymmetry, base = 1 + g * g - 2 * g * c;
  return 3 / (8 * pi) * (1 - g * g) * (1 + c * c) / ((2 + g * g) * base * std::sqrt(base));
}

}  // namespace

Atmosphere::Atmosphere(double turbidity, Vec3d ground_albedo, Vec3d to_sun)
    : to_sun_(to_sun), ground_albedo_(ground_albedo) {
  const double beta = 0.04608 * turbidity - 0.04586;
  for (int i = 0; i < 3; ++i) mie_scattering_[i] = mie_albedo * beta * std::pow(wavelengths[i], -1.3) / mie_height;
  fill_transmittance();
  fill_multiple_scattering();
}

Atmosphere::Medium Atmosphere::medium(double radius) const {
  const double height = radius - ground;
  const double ozone = std::max(0.0, 1 - std::abs(height - ozone_center) / ozone_half_width);
  Medium m;
  m.rayleigh = rayleigh_scattering * std::exp(-height / rayleigh_height);
  m.mie = mie_scattering_ * std::exp(-height / mie_height);
  m.extinction = m.rayleigh + m.mie / mie_albedo + ozone_absorption * ozone;
  return m;
}

Vec3d Atmosphere::Table::at(double x, double y) const {
  const double fx = std::clamp(x, 0.0, 1.0) * (width - 1), fy = std::clamp(y, 0.0, 1.0) * (height - 1);
  const int ix = std::min(int(fx), width - 2), iy = std::min(int(fy), height - 2);
  const Vec3d* row = values.data() + std::ptrdiff_t(iy) * width + ix;
  const double tx = fx - ix;
  return lerp(lerp(row[0], row[1], tx), lerp(row[width], row[width + 1], tx), fy - iy);
}

// Parametrised as in Bruneton 2017: by the height's distance to its horizon, and the distance to the top between its
// extremes.
void Atmosphere::fill_transmittance() {
  constexpr int steps = 48;
  constexpr int width = 96, height = 24;
  transmittance_ = {width, height, std::vector<Vec3d>(width * height)};
  const double horizon_of_top = std::sqrt(top * top - ground * ground);
  parallel_for(height, [&](std::size_t y) {
    const double horizon = horizon_of_top * double(y) / (height - 1);
    const double radius = std::sqrt(horizon * horizon + ground * ground);
    for (int x = 0; x < width; ++x) {
      const double nearest = top - radius, farthest = horizon + horizon_of_top;
      const double d = nearest + (farthest - nearest) * x / (width - 1);
      const double c = d > 0 ? std::clamp((top * top - radius * radius - d * d) / (2 * radius * d), -1.0, 1.0) : 1;
      Vec3d sum;
      for (int i = 0; i < steps; ++i) sum += medium(radius_along(radius, c, (i + 0.5) / steps * d)).extinction;
      transmittance_.values[y * width + std::size_t(x)] = sum * (d / steps);
    }
  });
}

Vec3d Atmosphere::optical_depth(double radius, double cosine) const {
  const double horizon_of_top = std::sqrt(top * top - ground * ground);
  const double horizon = std::sqrt(std::max(0.0, radius * radius - ground * ground));
  const double nearest = top - radius, farthest = horizon + horizon_of_top;
  const double d = distance_to_outer(radius, cosine, top);
  return transmittance_.at((d - nearest) / (farthest - nearest), horizon / horizon_of_top);
}

Vec3d Atmosphere::transmittance(Vec3d direction) const {
  return direction.y < 0 ? Vec3d{} : exp_of(-optical_depth(ground, direction.y));
}

Vec3d Atmosphere::sunlight(double radius, double cosine) const {
  const double s = ground / radius, horizon = -std::sqrt(std::max(0.0, 1 - s * s));
  const double seen = std::clamp((cosine - horizon) / (2 * sun_radius * s) + 0.5, 0.0, 1.0);
  if (seen == 0) return {};
  return exp_of(-optical_depth(radius, std::max(cosine, horizon))) * (seen * seen * (3 - 2 * seen));
}

// Pieces grow with the square of their number: the air is densest, and seen best, near the ground.
std::vector<Atmosphere::Piece> Atmosphere::pieces(double radius, double cosine, double end, int count,
                                                  Vec3d& through) const {
  std::vector<Piece> result;
  through = Vec3d(1.0);
  for (int k = 0; k < count; ++k) {
    const double t0 = end * k * k / (count * count), t1 = end * (k + 1) * (k + 1) / (count * count);
    const double t = (t0 + t1) / 2, r = radius_along(radius, cosine, t);
    const Medium m = medium(r);
    const Vec3d transmitted = exp_of(-m.extinction * (t1 - t0));
    result.push_back({t, r, m.rayleigh, m.mie, (Vec3d(1.0) - transmitted) / m.extinction, through});
    through *= transmitted;
  }
  return result;
}

// Rays from one height at one angle against the vertical.
struct Atmosphere::Ring {
  double cosine, end;  // where they leave the air or meet the ground
  bool meets_ground;
  std::vector<Piece> pieces;
  Vec3d through;  // all of it
};

Atmosphere::Ring Atmosphere::ring(double radius, double cosine) const {
  constexpr int steps = 16;
  const bool down = meets_ground(radius, cosine);
  const double end = down ? distance_to_ground(radius, cosine) : distance_to_outer(radius, cosine, top);
  Ring ring{cosine, end, down, {}, {}};
  ring.pieces = pieces(radius, cosine, end, steps, ring.through);
  return ring;
}

void Atmosphere::fill_multiple_scattering() {
  constexpr int width = 24, height = 12, rings = 8;
  multiple_scattering_ = {width, height, std::vector<Vec3d>(width * height)};
  std::vector<double> radii;
  std::vector<std::vector<Ring>> around(height);  // each height
  for (int y = 0; y < height; ++y) {
    const double h = (top - ground) * std::pow(double(y) / (height - 1), 2.0);
    radii.push_back(ground + std::clamp(h, 1e-3, top - ground - 1e-3));
    for (int i = 0; i < rings; ++i) around[std::size_t(y)].push_back(ring(radii.back(), 1 - 2 * (i + 0.5) / rings));
  }
  // From the end of a line of sight the sun stands higher or lower by the turn of the vertical at most
  const double zenith_angle = std::acos(std::clamp(to_sun_.y, -1.0, 1.0)), turn = std::acos(ground / top);
  const auto column = [](double angle) { return (std::cos(std::clamp(angle, 0.0, pi)) + 1) / 2 * (width - 1); };
  const int first = int(column(zenith_angle + turn)), last = std::min(width - 1, int(column(zenith_angle - turn)) + 1);
  const std::size_t columns = std::size_t(last - first + 1);
  parallel_for(columns * height, [&](std::size_t i) {
    const std::size_t x = std::size_t(first) + i % columns, y = i / columns;
    const double sun_cosine = -1 + 2.0 * double(x) / (width - 1);
    multiple_scattering_.values[y * width + x] = gathered(around[y], radii[y], sun_cosine);
  });
}

Vec3d Atmosphere::multiple_scattering(double radius, double sun_cosine) const {
  return multiple_scattering_.at((sun_cosine + 1) / 2, std::sqrt(std::max(0.0, (radius - ground) / (top - ground))));
}

// What a point gathers from all sides that was scattered twice or more, as if phases were isotropic (Hillaire's
// equations 5 to 10): second-order light, and the part f of unit light around the point that comes back, summed as
// the geometric series 1 / (1 - f).
Vec3d Atmosphere::gathered(const std::vector<Ring>& rings, double radius, double sun_cosine) const {
  constexpr int turns = 6;
  const double sun_sine = std::sqrt(std::max(0.0, 1 - sun_cosine * sun_cosine));
  Vec3d second, returned;
  for (const Ring& ring : rings)
    for (int turn = 0; turn < turns; ++turn) {
      const double angle = pi * (turn + 0.5) / turns, sine = std::sqrt(1 - ring.cosine * ring.cosine);
      const double cos_between = ring.cosine * sun_cosine + sine * sun_sine * std::cos(angle);  // the ray and the sun
      for (const Piece& p : ring.pieces) {
        const Vec3d scattered = p.through * (p.rayleigh + p.mie) * p.seen_length;
        second +=
            scattered * sunlight(p.radius, (radius * sun_cosine + p.distance * cos_between) / p.radius) / (4 * pi);
        returned += scattered;
      }
      if (ring.meets_ground) {
        const double cos_at_ground = (radius * sun_cosine + ring.end * cos_between) / ground;
        second += ring.through * ground_albedo_ * sunlight(ground, cos_at_ground) * (std::max(0.0, cos_at_ground) / pi);
      }
    }
  const double count = double(rings.size()) * turns;
  return second / count / (Vec3d(1.0) - returned / count);
}

std::vector<Atmosphere::Piece> Atmosphere::line_of_sight(double sine) const {
  constexpr int steps = 32;
  Vec3d through;
  return pieces(ground, sine, distance_to_outer(ground, sine, top), steps, through);
}

Atmosphere::Scattered Atmosphere::scattered(const std::vector<Piece>& line_of_sight, double between) const {
  Scattered sum;
  for (const Piece& p : line_of_sight) {
    const double sun_cosine = (ground * to_sun_.y + p.distance * between) / p.radius;
    const Vec3d seen = p.through * p.seen_length, lit = sunlight(p.radius, sun_cosine) * seen;
    sum.rayleigh += lit * p.rayleigh;
    sum.mie += lit * p.mie;
    sum.multiple += multiple_scattering(p.radius, sun_cosine) * (p.rayleigh + p.mie) * seen;
  }
  return sum;
}

Vec3d Atmosphere::sky_radiance(const Scattered& s, double between) {
  return s.rayleigh * rayleigh_phase(between) + s.mie * mie_phase(between) + s.multiple;
}

}  // namespace meristem
