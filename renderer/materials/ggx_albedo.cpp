#include "renderer/materials/ggx_albedo.h"

#include "renderer/materials/ggx.h"
#include "renderer/materials/lazy_rows.h"
#include "renderer/scene/warps.h"

#include <array>

namespace meristem::ggx {

namespace {
constexpr int fresnels = 48, alphas = 64, cosines = 96;
using Layers = std::array<float, fresnels + 1>;
}  // namespace

struct AlbedoRow {  // of one alpha
  std::array<std::array<float, cosines>, fresnels + 1> albedos;
  std::array<hemisphere_rule::Values, fresnels + 1> at_rule;
  Layers means;
};

namespace {

// A function on [0, 1] at `count` even places, as index and fraction for linear interpolation.
struct Place {
  int index;
  float fraction;
  Place(float x, int count) {
    const float f = std::clamp(x, 0.f, 1.f) * float(count - 1);
    index = std::min(int(f), count - 2);
    fraction = f - float(index);
  }
};

float mix(float a, float b, float t) { return a + (b - a) * t; }

// The rule of Gauss and Legendre on [0, 1].
constexpr int rule_size = 8;
constexpr float rule_at[rule_size] = {0.01985507f, 0.10166676f, 0.23723380f, 0.40828268f,
                                      0.59171732f, 0.76276620f, 0.89833324f, 0.98014493f};
constexpr float rule_weight[rule_size] = {0.05061427f, 0.11119052f, 0.15685332f, 0.18134189f,
                                          0.18134189f, 0.15685332f, 0.11119052f, 0.05061427f};

// Calls visit(wi, cosine to the normal, weight) for the mirror directions above the horizon of normals that wo sees,
// such that the sum of weight * g is the mean of g over those normals; 192 calls, within 0.0002 for g up to 1.
//
// It is sample_visible_normal() with t = sqrt(1 - random.y), turned over half a circle. For each t those turns whose
// mirror directions lie above the horizon are one interval, since with the normal not yet of unit length
// "2 (wo . h) h.z > wo.z (h . h)" is linear in the cosine of the turn. Where that interval begins to shrink and where
// it is gone, wi is horizontal and in the plane of wo: the integral over t is split there.
template <class Visit>
void visit_mirrored(Vec3f wo, float alpha, const Visit& visit) {
  const Vec3f v = normalize(Vec3f{alpha * wo.x, 0, wo.z});
  auto edge = [&](float horizontal) {
    const Vec3f u = normalize(Vec3f{(wo.x + horizontal) / alpha, 0, wo.z});
    return std::sqrt(std::clamp(2 * dot(u, v) * u.z / (1 + v.z), 0.f, 1.f));
  };
  const float e0 = edge(1), e1 = edge(-1), ends[] = {0, std::min(e0, e1), std::max(e0, e1), 1};
  for (int i = 0; i < 3 * rule_size; ++i) {
    // Nodes that crowd at both ends of a part even out the root with which the interval begins
    const float x = rule_at[i % rule_size], from = ends[i / rule_size], length = ends[i / rule_size + 1] - from;
    const float t = from + length * x * x * (3 - 2 * x);
    const float t_weight = rule_weight[i % rule_size] * length * 6 * x * (1 - x) * 2 * t;
    const float z = t * t * (1 + v.z) - v.z, s = std::sqrt(std::max(0.f, 1 - z * z)), h_z = z + v.z;
    const float a2 = alpha * alpha, o = alpha * wo.x * v.x + wo.z * h_z;
    const float slope = 2 * alpha * wo.x * s * h_z - 2 * a2 * s * v.x * wo.z;
    const float least = wo.z * (a2 * (s * s + v.x * v.x) + h_z * h_z) - 2 * o * h_z;  // slope * cos(turn) > least
    float turn_from = 0, turn_to = pi_f;
    if (std::abs(slope) > 1e-12f)
      (slope > 0 ? turn_to : turn_from) = std::acos(std::clamp(least / slope, -1.f, 1.f));
    else if (least >= 0)
      continue;
    for (int k = 0; k < rule_size; ++k) {
      const float turn = turn_from + (turn_to - turn_from) * rule_at[k];
      const Vec3f h = normalize(Vec3f{alpha * (s * std::cos(turn) + v.x), alpha * s * std::sin(turn), h_z});
      const float cosine = dot(wo, h);
      const Vec3f wi = h * (2 * cosine) - wo;
      if (wi.z > 0) visit(wi, cosine, t_weight * rule_weight[k] * (turn_to - turn_from) / pi_f);
    }
  }
}

// Albedos over (fourth root of f0, fourth root of alpha, root of the cosine): the roots even out where they change
// fast. The last layer of f0 stands for a Fresnel term of 1.
class AlbedoTable {
 public:
  static const AlbedoTable& get() {
    static const AlbedoTable table;
    return table;
  }

  const AlbedoRow& row(int a) const { return rows_.at(std::size_t(a), make_row); }

  // Even steps of the fourth root of alpha, from its least to 1.
  static float alpha_at(float x) { return std::pow(mix(std::pow(min_alpha, 0.25f), 1, x), 4.f); }
  static Place place_of_alpha(float alpha) {
    const float least = std::sqrt(std::sqrt(min_alpha));
    return {(std::sqrt(std::sqrt(alpha)) - least) / (1 - least), alphas};
  }

  // Layer i has a fourth root of f0 of i / (fresnels - 1), of the largest. Between layers it is about linear in the
  // logarithm of that, since at grazing angles a Fresnel term is a function of the cosine over it.
  static float f0_at(int i) { return std::pow(float(i) / (fresnels - 1), 4.f) * max_f0; }
  static Place place_of_f0(float f0) {
    Place p(std::sqrt(std::sqrt(std::clamp(f0 / max_f0, 0.f, 1.f))), fresnels);
    p.fraction *= 1 + (1 - p.fraction) / (2 * (float(p.index) + p.fraction) + 1);
    return p;
  }

 private:
  static AlbedoRow make_row(std::size_t a) {
    AlbedoRow row{};
    for (std::size_t c = 0; c < cosines; ++c) {
      const Layers layers = integrate(int(a), int(c));
      for (std::size_t f = 0; f <= fresnels; ++f) row.albedos[f][c] = layers[f];
    }
    for (std::size_t f = 0; f <= fresnels; ++f) {
      row.means[f] = integrate_mean(row.albedos[f]);
      row.at_rule[f] = hemisphere_rule::of_table(row.albedos[f]);
    }
    return row;
  }

  // The Fresnel terms of all layers at once, a loop that the compiler turns into vectors: fresnel_dielectric().
  static void add_fresnel(float c, float weight, Layers& sums) {
    static const Layers etas = [] {
      Layers e{};
      for (int f = 0; f < fresnels; ++f) e[std::size_t(f)] = eta_of(f0_at(f));
      return e;
    }();
    for (std::size_t f = 0; f < fresnels; ++f) {
      const float eta = etas[f], ct = std::sqrt(eta * eta - 1 + c * c);  // eta times the refracted cosine
      const float perpendicular = (c - ct) / (c + ct), parallel = (eta * eta * c - ct) / (eta * eta * c + ct);
      sums[f] += weight * 0.5f * (parallel * parallel + perpendicular * perpendicular);
    }
    sums[fresnels] += weight;
  }

  // The mean of F G2 / G1 over visible normals.
  static Layers integrate(int a, int c) {
    const float alpha = alpha_at(float(a) / (alphas - 1));
    const float z = std::max(std::pow(float(c) / (cosines - 1), 2.f), 1e-5f);
    const Vec3f wo{std::sqrt(1 - z * z), 0, z};
    const float lambda_o = lambda(wo, alpha);
    Layers sums{};
    visit_mirrored(wo, alpha, [&](Vec3f wi, float cosine, float weight) {
      add_fresnel(cosine, weight * (1 + lambda_o) / (1 + lambda_o + lambda(wi, alpha)), sums);
    });
    return sums;
  }

  // Of the interpolated table, so that what divides by it keeps its energy.
  static float integrate_mean(const std::array<float, cosines>& albedos) {
    constexpr int steps = 512;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
      const float c = (float(i) + 0.5f) / steps;
      const Place p(std::sqrt(c), cosines);
      const float* v = albedos.data() + p.index;
      sum += double(mix(v[0], v[1], p.fraction) * 2 * c);
    }
    return float(sum / steps);
  }

  LazyRows<AlbedoRow, alphas> rows_;
};

// Over (1 - 1/eta, fourth root of alpha, root of the cosine), from outside and from inside.
class GlassTable {
 public:
  static const GlassTable& get() {
    static const GlassTable table;
    return table;
  }

  float at(float c, float alpha, float eta, bool inside) const {
    const Place n((1 - 1 / eta) / (1 - 1 / max_eta), etas), a(std::sqrt(std::sqrt(alpha)), glass_alphas);
    const Place p(std::sqrt(std::max(c, 0.f)), glass_cosines);
    auto row = [&](int e, int k) {
      const float* v = rows_.at(std::size_t((inside * etas + e) * glass_alphas + k), make_row).data() + p.index;
      return mix(v[0], v[1], p.fraction);
    };
    auto layer = [&](int e) { return mix(row(e, a.index), row(e, a.index + 1), a.fraction); };
    return mix(layer(n.index), layer(n.index + 1), n.fraction);
  }

 private:
  static constexpr int etas = 10, glass_alphas = 20, glass_cosines = 32;
  static constexpr float max_eta = 4;

  using Row = std::array<float, glass_cosines>;  // of one side, eta and alpha

  static Row make_row(std::size_t i) {
    const int e = int(i) / glass_alphas;
    const float eta = 1 / (1 - (1 - 1 / max_eta) * float(e % etas) / (etas - 1));
    const float alpha = std::max(std::pow(float(int(i) % glass_alphas) / (glass_alphas - 1), 4.f), min_alpha);
    Row row{};
    for (int c = 0; c < glass_cosines; ++c) {
      const float root = std::max(float(c) / (glass_cosines - 1), 0.01f);
      row[std::size_t(c)] = integrate(root * root, alpha, e < etas ? eta : 1 / eta);
    }
    return row;
  }

  // As AlbedoTable::integrate(); what is refracted is dimmed by masking alike.
  static float integrate(float c, float alpha, float eta) {
    constexpr int turns = 12, steps = 24;
    const Vec3f wo{std::sqrt(1 - c * c), 0, c};
    float sum = 0;
    for (int i = 0; i < steps * turns; ++i) {
      const float t = (float(i / turns) + 0.5f) / steps;
      const Vec3f h = sample_visible_normal(wo, alpha, {(float(i % turns) + 0.5f) / (2 * turns), 1 - t * t});
      const float f = fresnel_dielectric(dot(wo, h), eta);
      const Vec3f mirrored = h * (2 * dot(wo, h)) - wo, refracted = refract(wo, h, eta);
      float kept = mirrored.z > 0 ? f * masking_shadowing(wo, mirrored, alpha) : 0;
      if (refracted.z < 0) kept += (1 - f) * masking_shadowing(wo, refracted, alpha);
      sum += 2 * t * kept;
    }
    return sum / (steps * turns) / masking(wo, alpha);
  }

  LazyRows<Row, 2 * etas * glass_alphas> rows_;
};

}  // namespace

Albedo Albedo::dielectric(float alpha, float f0) {
  const Place f = AlbedoTable::place_of_f0(f0);
  Albedo albedo = white(alpha);
  albedo.layer_ = f.index;
  albedo.by_f0_ = f.fraction;
  return albedo;
}

Albedo Albedo::white(float alpha) {
  const AlbedoTable& table = AlbedoTable::get();
  const Place a = AlbedoTable::place_of_alpha(alpha);
  Albedo albedo;
  albedo.smoother_ = &table.row(a.index);
  albedo.rougher_ = &table.row(a.index + 1);
  albedo.layer_ = fresnels;
  albedo.by_alpha_ = a.fraction;
  return albedo;
}

float Albedo::at(float c) const {
  const Place p(std::sqrt(std::max(c, 0.f)), cosines);
  auto layer = [&](int i) {
    const float* s = smoother_->albedos[std::size_t(i)].data() + p.index;
    const float* r = rougher_->albedos[std::size_t(i)].data() + p.index;
    return mix(mix(s[0], s[1], p.fraction), mix(r[0], r[1], p.fraction), by_alpha_);
  };
  return by_f0_ == 0 ? layer(layer_) : mix(layer(layer_), layer(layer_ + 1), by_f0_);
}

float Albedo::mean() const {
  auto layer = [&](int i) { return mix(smoother_->means[std::size_t(i)], rougher_->means[std::size_t(i)], by_alpha_); };
  return by_f0_ == 0 ? layer(layer_) : mix(layer(layer_), layer(layer_ + 1), by_f0_);
}

hemisphere_rule::Values Albedo::at_rule() const {
  const auto i = std::size_t(layer_), next = by_f0_ == 0 ? i : i + 1;
  const hemisphere_rule::Values &s0 = smoother_->at_rule[i], &s1 = smoother_->at_rule[next];
  const hemisphere_rule::Values &r0 = rougher_->at_rule[i], &r1 = rougher_->at_rule[next];
  hemisphere_rule::Values values;
  for (std::size_t k = 0; k < values.size(); ++k)
    values[k] = mix(mix(s0[k], r0[k], by_alpha_), mix(s1[k], r1[k], by_alpha_), by_f0_);
  return values;
}

float glass_albedo(float c, float alpha, float eta, bool inside) { return GlassTable::get().at(c, alpha, eta, inside); }

}  // namespace meristem::ggx
