#include "renderer/materials/ggx_albedo.h"

#include "renderer/materials/albedo_grid.h"
#include "renderer/materials/lazy_rows.h"
#include "renderer/materials/visible_ring.h"

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

// Calls visit(wi, cosine to the normal, weight) for the mirror directions above the horizon of normals that wo sees,
// such that the sum of weight * g is the mean of g over those normals; 192 calls, within 0.0002 for g up to 1.
//
// The turns of a ring whose mirror directions lie above the horizon are one interval. Where that begins to shrink and
// where it is gone, wi is horizontal and in the plane of wo: the integral over rings is split there.
template <class Visit>
void visit_mirrored(Vec3f wo, float alpha, const Visit& visit) {
  auto edge = [&](float horizontal) { return VisibleRing::through(wo, alpha, {wo.x + horizontal, 0, wo.z}); };
  const float e0 = edge(1), e1 = edge(-1), ends[] = {0, std::min(e0, e1), std::max(e0, e1), 1};
  for (int i = 0; i < 3 * rule_size; ++i) {
    const CrowdedNode t(i % rule_size, ends[i / rule_size], ends[i / rule_size + 1]);
    const VisibleRing ring(wo, alpha, t.at);
    const auto [from, to] = ring.mirrored_above();
    for (int k = 0; k < rule_size; ++k) {
      const Vec3f h = ring.normal(from + (to - from) * rule_at[k]);
      const float cosine = dot(wo, h);
      const Vec3f wi = h * (2 * cosine) - wo;
      if (wi.z > 0) visit(wi, cosine, t.weight * 2 * t.at * rule_weight[k] * (to - from) / pi_f);
    }
  }
}

// Albedos over (f0, alpha, cosine), on the axes of albedo_grid.h. The last layer of f0 stands for a Fresnel term of 1.
class AlbedoTable {
 public:
  static const AlbedoTable& get() {
    static const AlbedoTable table;
    return table;
  }

  const AlbedoRow& row(int a) const { return rows_.at(std::size_t(a), make_row); }

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
      for (int f = 0; f < fresnels; ++f) e[std::size_t(f)] = eta_of(f0_at(f, fresnels));
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
    const float alpha = alpha_at(a, alphas);
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
      const Place p = place_of_cosine(c, cosines);
      const float* v = albedos.data() + p.index;
      sum += double(mix(v[0], v[1], p.fraction) * 2 * c);
    }
    return float(sum / steps);
  }

  LazyRows<AlbedoRow, alphas> rows_;
};

}  // namespace

Albedo Albedo::dielectric(float alpha, float f0) {
  const Place f = place_of_f0(f0, fresnels);
  Albedo albedo = white(alpha);
  albedo.layer_ = f.index;
  albedo.by_f0_ = f.fraction;
  return albedo;
}

Albedo Albedo::white(float alpha) {
  const AlbedoTable& table = AlbedoTable::get();
  const Place a = place_of_alpha(alpha, alphas);
  Albedo albedo;
  albedo.smoother_ = &table.row(a.index);
  albedo.rougher_ = &table.row(a.index + 1);
  albedo.layer_ = fresnels;
  albedo.by_alpha_ = a.fraction;
  return albedo;
}

float Albedo::at(float c) const {
  const Place p = place_of_cosine(c, cosines);
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

}  // namespace meristem::ggx
