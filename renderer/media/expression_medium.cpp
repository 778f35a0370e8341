#include "renderer/media/expression_medium.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace meristem {

namespace {

constexpr int majorant_cells = 32768;
// A bound, so that no scene can hang a render: of a flight through matter whose majorants are far too large.
constexpr int max_batches = 1 << 16;

const Symbols& medium_symbols() {
  static const Symbols symbols = [] {
    Symbols s;
    s.add("P", ValueType::Vector, "position, world space, metres");
    return s;
  }();
  return symbols;
}

// NaN is 0.
float cleaned(float x, float upper) { return x > 0 ? std::min(x, upper) : 0; }

}  // namespace

ExpressionMedium::ExpressionMedium(Params& params) {
  const Symbols& symbols = medium_symbols();
  density_ = params.scalar_expression("density", "0.1", symbols,
                                      "how often light collides with its matter, per metre; negative is 0");
  albedo_ = params.vector_expression("albedo", "1", symbols, "the part that is scattered; the rest is absorbed");
  emission_ = params.vector_expression("emission", "0", symbols, "radiance of its matter, seen where it is thick");
  anisotropy_ = float(params.real("anisotropy", 0, {-0.99, 0.99, ""},
                                  "mean cosine of scattering: above 0 forwards, below 0 backwards, 0 evenly"));
  const Vec3f from(params.vector("from", {0, 0, 0}, any_range, "a corner of its box; without, it fills the scene's"));
  const Vec3f to(params.vector("to", {0, 0, 0}, any_range, "the opposite corner"));
  if (params.describing() || (!params.has("from") && !params.has("to"))) return;
  const Bounds3f box{min(from, to), max(from, to)};
  const Vec3f size = box.size();
  if (!params.has("from") || !params.has("to") || !(size.x > 0 && size.y > 0 && size.z > 0))
    params.error(params.has("to") ? "to" : "from",
                 "a medium's box has two corners, \"from\" and \"to\", that differ in x, y and z");
  else
    box_ = box;
}

void ExpressionMedium::fill(const Bounds3f& scene) {
  const Bounds3f box = box_.value_or(scene);
  const Vec3f size = box.size();
  if (box.empty() || !(size.x > 0 && size.y > 0 && size.z > 0))
    throw std::runtime_error(
        "a medium that is to fill the scene needs objects that span a box; or give it \"from\" and \"to\"");
  majorants_ = MajorantGrid(box, density_->is_constant() ? 1 : majorant_cells,
                            [this](const Bounds3d& cell) { return bound(cell); });
  if (majorants_.largest() > max_density)
    throw std::runtime_error(fmt::format(
        "the density may reach {:.3g} per metre in the medium's box; the limit is {}: min(..., {}) would bound it",
        majorants_.largest(), max_density, max_density));
}

float ExpressionMedium::bound(const Bounds3d& cell) const {
  const Bounds3f box = round_outwards(cell);
  IntervalValue p;
  p.x = {box.lower.x, box.upper.x};
  p.y = {box.lower.y, box.upper.y};
  p.z = {box.lower.z, box.upper.z};
  return std::max(density_->evaluate_bounds({&p, 1}).x.upper, 0.f);
}

struct ExpressionMedium::Candidates {
  int count = 0;
  std::array<float, batch> t, majorant, density;
  std::array<std::array<float, batch>, 3> place;
};

// The next candidates, fewer than a batch only at the end of the ray. False if there are none.
bool ExpressionMedium::look(const Ray& ray, TentativeCollisions& tentative, RandomStream& random, Candidates& c) const {
  c.count = 0;
  while (c.count < batch) {
    const auto i = std::size_t(c.count);
    if (!tentative.next(random, c.t[i], c.majorant[i])) break;
    const Vec3f place = ray.origin + ray.direction * c.t[i];
    for (std::size_t axis = 0; axis < 3; ++axis) c.place[axis][i] = place[int(axis)];
    ++c.count;
  }
  if (c.count > 0) densities(c);
  return c.count > 0;
}

void ExpressionMedium::densities(Candidates& c) const {
  const Input p{c.place[0].data(), c.place[1].data(), c.place[2].data(), 1};
  density_->evaluate({c.count, {&p, 1}}, c.density.data(), nullptr, nullptr);
  for (std::size_t i = 0; i < std::size_t(c.count); ++i) c.density[i] = cleaned(c.density[i], c.majorant[i]);
}

bool ExpressionMedium::collide(const Ray& ray, RandomStream& random, MediumCollision& collision) const {
  TentativeCollisions tentative(majorants_, ray);
  Candidates c;
  for (int round = 0; round < max_batches && look(ray, tentative, random, c); ++round)
    for (std::size_t i = 0; i < std::size_t(c.count); ++i) {
      if (random.next() * c.majorant[i] >= c.density[i]) continue;  // nothing was there
      const Vec3f place = ray.origin + ray.direction * c.t[i];
      collision = {c.t[i], color(*albedo_, place, 1), color(*emission_, place, 1e10f), anisotropy_};
      return true;
    }
  return false;
}

float ExpressionMedium::transmittance(const Ray& ray, RandomStream& random) const {
  constexpr float weak = 0.05f, survival = 0.25f;
  TentativeCollisions tentative(majorants_, ray);
  Candidates c;
  float passed = 1;
  for (int round = 0; round < max_batches && look(ray, tentative, random, c); ++round) {
    for (std::size_t i = 0; i < std::size_t(c.count); ++i) passed *= 1 - c.density[i] / c.majorant[i];
    if (passed == 0) return 0;
    if (passed < weak) {  // Russian roulette
      if (random.next() >= survival) return 0;
      passed /= survival;
    }
  }
  return passed;
}

Spectrum ExpressionMedium::color(const Expression& e, Vec3f place, float upper) const {
  const Input p{&place.x, &place.y, &place.z, 0};
  Spectrum s;
  e.evaluate({1, {&p, 1}}, &s.x, &s.y, &s.z);
  return {cleaned(s.x, upper), cleaned(s.y, upper), cleaned(s.z, upper)};
}

}  // namespace meristem
