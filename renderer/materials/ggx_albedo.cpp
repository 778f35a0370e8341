#include "renderer/materials/ggx_albedo.h"

#include "renderer/materials/ggx.h"
#include "renderer/materials/lazy_rows.h"

#include <array>

namespace meristem::ggx {
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

// Albedos over (root of f0, fourth root of alpha, root of the cosine): the roots even out where they change fast.
// The last layer of f0 stands for a Fresnel term of 1.
class AlbedoTable {
 public:
  static const AlbedoTable& get() {
    static const AlbedoTable table;
    return table;
  }

  float dielectric(float c, float alpha, float f0) const {
    const Place p(std::sqrt(f0 / max_f0), fresnels);
    return mix(albedo(p.index, alpha, c), albedo(p.index + 1, alpha, c), p.fraction);
  }
  float white(float c, float alpha) const { return albedo(fresnels, alpha, c); }
  float dielectric_mean(float alpha, float f0) const {
    const Place p(std::sqrt(f0 / max_f0), fresnels);
    return mix(mean(p.index, alpha), mean(p.index + 1, alpha), p.fraction);
  }
  float white_mean(float alpha) const { return mean(fresnels, alpha); }

 private:
  static constexpr int fresnels = 16, alphas = 32, cosines = 48;
  using Layers = std::array<float, fresnels + 1>;

  struct Row {  // of one alpha
    std::array<std::array<float, cosines>, fresnels + 1> albedos;
    Layers means;
  };

  static Row make_row(std::size_t a) {
    Row row{};
    for (std::size_t c = 0; c < cosines; ++c) {
      const Layers layers = integrate(int(a), int(c));
      for (std::size_t f = 0; f <= fresnels; ++f) row.albedos[f][c] = layers[f];
    }
    for (std::size_t f = 0; f <= fresnels; ++f) row.means[f] = integrate_mean(row.albedos[f]);
    return row;
  }

  // Even steps of the fourth root of alpha, from its least to 1.
  static float alpha_at(float x) { return std::pow(mix(std::pow(min_alpha, 0.25f), 1, x), 4.f); }
  static Place place_of(float alpha) {
    const float least = std::sqrt(std::sqrt(min_alpha));
    return {(std::sqrt(std::sqrt(alpha)) - least) / (1 - least), alphas};
  }

  // The Fresnel terms of all layers at once, a loop that the compiler turns into vectors: fresnel_dielectric().
  static void add_fresnel(float c, float weight, Layers& sums) {
    static const Layers etas = [] {
      Layers e{};
      for (int f = 0; f < fresnels; ++f)
        e[std::size_t(f)] = eta_of(float(f * f) / float((fresnels - 1) * (fresnels - 1)) * max_f0);
      return e;
    }();
    for (std::size_t f = 0; f < fresnels; ++f) {
      const float eta = etas[f], ct = std::sqrt(eta * eta - 1 + c * c);  // eta times the refracted cosine
      const float perpendicular = (c - ct) / (c + ct), parallel = (eta * eta * c - ct) / (eta * eta * c + ct);
      sums[f] += weight * 0.5f * (parallel * parallel + perpendicular * perpendicular);
    }
    sums[fresnels] += weight;
  }

  // The mean of F G2 / G1 over visible normals, by the midpoint rule; turns of one half-plane are those of the other.
  // random.y is 1 - t^2, since the normals that reflect below the horizon crowd near 1.
  static Layers integrate(int a, int c) {
    constexpr int turns = 16, steps = 40;
    const float alpha = alpha_at(float(a) / (alphas - 1));
    const float z = std::max(std::pow(float(c) / (cosines - 1), 2.f), 1e-5f);
    const Vec3f wo{std::sqrt(1 - z * z), 0, z};
    const float lambda_o = lambda(wo, alpha);
    Layers sums{};
    for (int i = 0; i < steps; ++i) {
      const float t = (float(i) + 0.5f) / steps;
      for (int k = 0; k < turns; ++k) {
        const Vec3f h = sample_visible_normal(wo, alpha, {(float(k) + 0.5f) / (2 * turns), 1 - t * t});
        const float cosine = dot(wo, h);
        const Vec3f wi = h * (2 * cosine) - wo;
        if (wi.z <= 0) continue;
        const float weight = (1 + lambda_o) / (1 + lambda_o + lambda(wi, alpha));
        add_fresnel(cosine, weight * 2 * t / (steps * turns), sums);
      }
    }
    return sums;
  }

  // Of the interpolated table, so that what divides by it keeps its energy.
  static float integrate_mean(const std::array<float, cosines>& albedos) {
    constexpr int steps = 256;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
      const float c = (float(i) + 0.5f) / steps;
      const Place p(std::sqrt(c), cosines);
      const float* v = albedos.data() + p.index;
      sum += double(mix(v[0], v[1], p.fraction) * 2 * c);
    }
    return float(sum / steps);
  }

  const Row& row(int a) const { return rows_.at(std::size_t(a), make_row); }
  float albedo(int f, float alpha, float c) const {
    const Place a = place_of(alpha), p(std::sqrt(std::max(c, 0.f)), cosines);
    auto at = [&](int k) {
      const float* v = row(k).albedos[std::size_t(f)].data() + p.index;
      return mix(v[0], v[1], p.fraction);
    };
    return mix(at(a.index), at(a.index + 1), a.fraction);
  }
  float mean(int f, float alpha) const {
    const Place a = place_of(alpha);
    return mix(row(a.index).means[std::size_t(f)], row(a.index + 1).means[std::size_t(f)], a.fraction);
  }

  LazyRows<Row, alphas> rows_;
};

// Over (1 - 1/eta, fourth root of alpha, root of the cosine), from outside and from inside.
class GlassTable {
 public:
  static const GlassTable& get() {
    static const GlassTable table;
    return table;
  }

  float at(float c, float alpha, float eta, bool inside) const {
    const Place n((1 - 1 / eta) / (1 - 1 / max_eta), etas), a(std::sqrt(std::sqrt(alpha)), alphas);
    const Place p(std::sqrt(std::max(c, 0.f)), cosines);
    auto row = [&](int e, int k) {
      const float* v = rows_.at(std::size_t((inside * etas + e) * alphas + k), make_row).data() + p.index;
      return mix(v[0], v[1], p.fraction);
    };
    auto layer = [&](int e) { return mix(row(e, a.index), row(e, a.index + 1), a.fraction); };
    return mix(layer(n.index), layer(n.index + 1), n.fraction);
  }

 private:
  static constexpr int etas = 10, alphas = 20, cosines = 32;
  static constexpr float max_eta = 4;

  using Row = std::array<float, cosines>;  // of one side, eta and alpha

  static Row make_row(std::size_t i) {
    const int e = int(i) / alphas;
    const float eta = 1 / (1 - (1 - 1 / max_eta) * float(e % etas) / (etas - 1));
    const float alpha = std::max(std::pow(float(int(i) % alphas) / (alphas - 1), 4.f), min_alpha);
    Row row{};
    for (int c = 0; c < cosines; ++c) {
      const float root = std::max(float(c) / (cosines - 1), 0.01f);
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

  LazyRows<Row, 2 * etas * alphas> rows_;
};

}  // namespace

float dielectric_albedo(float c, float alpha, float f0) { return AlbedoTable::get().dielectric(c, alpha, f0); }
float dielectric_mean_albedo(float alpha, float f0) { return AlbedoTable::get().dielectric_mean(alpha, f0); }
float white_albedo(float c, float alpha) { return AlbedoTable::get().white(c, alpha); }
float white_mean_albedo(float alpha) { return AlbedoTable::get().white_mean(alpha); }
float glass_albedo(float c, float alpha, float eta, bool inside) { return GlassTable::get().at(c, alpha, eta, inside); }

}  // namespace meristem::ggx
