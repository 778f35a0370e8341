#include "renderer/materials/ggx.h"

#include "renderer/scene/warps.h"

#include <array>
#include <vector>

namespace meristem::ggx {

float distribution(Vec3f h, float alpha) {
  const float z2 = h.z * h.z;
  if (!(z2 > 0)) return 0;
  const float a2 = alpha * alpha;
  const float e = (h.x * h.x + h.y * h.y) / a2 + z2;  // tan^2 / a^2 + 1, times z^2
  return 1 / (pi_f * a2 * e * e);
}

float lambda(Vec3f w, float alpha) {
  const float z2 = w.z * w.z;
  const float tangent2 = (w.x * w.x + w.y * w.y) / std::max(z2, 1e-20f);
  return 0.5f * (std::sqrt(1 + alpha * alpha * tangent2) - 1);
}

// Directions flatter than this scatter nothing: the quotients below would overflow.
constexpr float min_cosine = 1e-7f;

float reflectance(Vec3f wo, Vec3f wi, float alpha) {
  if (!(wo.z > min_cosine && wi.z > min_cosine)) return 0;
  const Vec3f h = normalize(wo + wi);
  return distribution(h, alpha) * masking_shadowing(wo, wi, alpha) / (4 * wo.z * wi.z);
}

Vec3f sample_visible_normal(Vec3f wo, float alpha, Vec2f random) {
  const Vec3f v = normalize(Vec3f{alpha * wo.x, alpha * wo.y, wo.z});
  const float angle = 2 * pi_f * random.x;
  const float z = (1 - random.y) * (1 + v.z) - v.z;
  const float sine = std::sqrt(std::clamp(1 - z * z, 0.f, 1.f));
  const Vec3f h = Vec3f{sine * std::cos(angle), sine * std::sin(angle), z} + v;
  return normalize(Vec3f{alpha * h.x, alpha * h.y, std::max(h.z, 1e-9f)});
}

float reflected_pdf(Vec3f wo, Vec3f wi, float alpha) {
  if (!(wo.z > min_cosine && wi.z > min_cosine)) return 0;
  return masking(wo, alpha) * distribution(normalize(wo + wi), alpha) / (4 * wo.z);
}

float fresnel_dielectric(float cosine, float eta) {
  const float c = std::clamp(cosine, 0.f, 1.f);
  const float ct = std::sqrt(std::max(0.f, 1 - (1 - c * c) / (eta * eta)));
  const float parallel = (eta * c - ct) / (eta * c + ct), perpendicular = (c - eta * ct) / (c + eta * ct);
  return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

float eta_of(float f0) {
  const float s = std::sqrt(f0);
  return (1 + s) / (1 - s);
}
float f0_of(float eta) {
  const float s = (eta - 1) / (eta + 1);
  return s * s;
}

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

// Directional albedos over (root of f0, fourth root of alpha, root of the cosine): the roots even out where they change
// fast. The last layer of f0 stands for a Fresnel term of 1.
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
  static constexpr int fresnels = 12, alphas = 24, cosines = 40, side = 12;

  AlbedoTable() : albedos_(std::size_t((fresnels + 1) * alphas * cosines)) {
    for (int a = 0; a < alphas; ++a) {
      for (int c = 0; c < cosines; ++c) integrate(a, c);
      for (int f = 0; f <= fresnels; ++f) means_[std::size_t(f)][std::size_t(a)] = integrate_mean(f, a);
    }
  }

  float& value(int f, int a, int c) { return albedos_[std::size_t((f * alphas + a) * cosines + c)]; }

  // Even steps of the fourth root of alpha, from its least to 1.
  static float alpha_at(float x) { return std::pow(mix(std::pow(min_alpha, 0.25f), 1, x), 4.f); }
  static Place place_of(float alpha) {
    const float least = std::sqrt(std::sqrt(min_alpha));
    return {(std::sqrt(std::sqrt(alpha)) - least) / (1 - least), alphas};
  }

  // The mean of F G2 / G1 over visible normals, on a grid of side^2 random numbers.
  void integrate(int a, int c) {
    const float alpha = alpha_at(float(a) / (alphas - 1));
    const float z = std::max(std::pow(float(c) / (cosines - 1), 2.f), 1e-5f);
    const Vec3f wo{std::sqrt(1 - z * z), 0, z};
    std::array<double, fresnels + 1> sums{};
    for (int i = 0; i < side * side; ++i) {
      const Vec2f random{(float(i % side) + 0.5f) / side, (float(i / side) + 0.5f) / side};
      const Vec3f h = sample_visible_normal(wo, alpha, random);
      const float cosine = dot(wo, h);
      const Vec3f wi = h * (2 * cosine) - wo;
      if (wi.z <= 0) continue;
      const float weight = masking_shadowing(wo, wi, alpha) / masking(wo, alpha);
      for (int f = 0; f < fresnels; ++f) {
        const float s = float(f) / (fresnels - 1);
        sums[std::size_t(f)] += double(weight * fresnel_dielectric(cosine, eta_of(s * s * max_f0)));
      }
      sums[fresnels] += double(weight);
    }
    for (int f = 0; f <= fresnels; ++f) value(f, a, c) = float(sums[std::size_t(f)] / (side * side));
  }

  // Of the interpolated table, so that what divides by it keeps its energy.
  float integrate_mean(int f, int a) const {
    constexpr int steps = 256;
    const float alpha = alpha_at(float(a) / (alphas - 1));
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
      const float c = (float(i) + 0.5f) / steps;
      sum += double(albedo(f, alpha, c) * 2 * c);
    }
    return float(sum / steps);
  }

  float albedo(int f, float alpha, float c) const {
    const Place a = place_of(alpha), p(std::sqrt(std::max(c, 0.f)), cosines);
    const float* row = albedos_.data() + std::ptrdiff_t((f * alphas + a.index) * cosines + p.index);
    return mix(mix(row[0], row[1], p.fraction), mix(row[cosines], row[cosines + 1], p.fraction), a.fraction);
  }
  float mean(int f, float alpha) const {
    const Place a = place_of(alpha);
    const auto& row = means_[std::size_t(f)];
    return mix(row[std::size_t(a.index)], row[std::size_t(a.index) + 1], a.fraction);
  }

  std::vector<float> albedos_;
  std::array<std::array<float, alphas>, fresnels + 1> means_{};
};

}  // namespace

float dielectric_albedo(float c, float alpha, float f0) { return AlbedoTable::get().dielectric(c, alpha, f0); }
float dielectric_mean_albedo(float alpha, float f0) { return AlbedoTable::get().dielectric_mean(alpha, f0); }
float white_albedo(float c, float alpha) { return AlbedoTable::get().white(c, alpha); }
float white_mean_albedo(float alpha) { return AlbedoTable::get().white_mean(alpha); }

}  // namespace meristem::ggx
