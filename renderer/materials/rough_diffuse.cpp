#include "renderer/materials/rough_diffuse.h"

#include "renderer/scene/warps.h"

namespace meristem {

namespace {

namespace rule = hemisphere_rule;

// EON, section 2: the scale at which the first lobe reflects all of grazing light, 1 / (1 + steepness * roughness).
constexpr float steepness = 0.5f - 2 / (3 * pi_f);

// The first lobe adds r * s / t to a Lambertian, where s is the cosine of wo and wi less the product of their z, and t
// the larger z if s > 0, else 1. Around the normal, s / t comes to 2 sin sin (1 / t - 1). So what it adds to the albedo
// below layers that pass T is r / pi times
//   g(c) = 2 sin [ (1 / c) * integral of sin T z over z < c  +  integral of sin T over z > c  -  integral of sin T z ],
// linear in T, and T is known by its values at a few cosines. This is g, for each of these values, by the root of c.
class Excess {
 public:
  static const Excess& get() {
    static const Excess excess;
    return excess;
  }

  float at(float c, const rule::Values& passed) const {
    const float x = std::sqrt(std::clamp(c, 0.f, 1.f)) * (places - 1);
    const auto i = std::min(std::size_t(x), places - 2);
    const float t = x - float(i);
    const rule::Values &a = of_values_[i], &b = of_values_[i + 1];
    rule::Values of_value;
    for (std::size_t j = 0; j < rule::count; ++j) of_value[j] = a[j] + (b[j] - a[j]) * t;
    return rule::dot(of_value, passed);
  }
  // The integral of 2 c T g.
  float mean(const rule::Values& passed) const {
    rule::Values of_value{};
    for (std::size_t j = 0; j < rule::count; ++j)
      for (std::size_t k = 0; k < rule::count; ++k) of_value[k] += passed[j] * products_[j][k];
    return rule::dot(of_value, passed);
  }

 private:
  static constexpr std::size_t places = 128;
  using Values = std::array<double, rule::count>;

  // What a value of T counts for between the roots: the polynomial that is 1 at its root and 0 at the others.
  static Values shares(double root) {
    Values shares;
    for (std::size_t j = 0; j < rule::count; ++j) {
      shares[j] = 1;
      for (std::size_t k = 0; k < rule::count; ++k)
        if (k != j) shares[j] *= (root - rule::roots[k]) / (rule::roots[j] - rule::roots[k]);
    }
    return shares;
  }

  // Calls visit(root, weight) for the integral over z in the interval of roots that ends at that place.
  template <class Visit>
  static void visit_interval(std::size_t place, const Visit& visit) {
    constexpr double at[] = {0.06943184420297371, 0.33000947820757187, 0.6699905217924281, 0.9305681557970263};
    constexpr double weight[] = {0.17392742256872692, 0.32607257743127307, 0.32607257743127307, 0.17392742256872692};
    constexpr double step = 1.0 / (places - 1);
    for (int i = 0; i < 4; ++i) {
      const double root = (double(place - 1) + at[i]) * step;
      visit(root, weight[i] * step * 2 * root);
    }
  }
  static double sine(double root) { return std::sqrt(std::max(0.0, 1 - std::pow(root, 4))); }

  Excess() {
    std::array<Values, places> below{}, sines{};  // the integrals of sin T z and of sin T up to each place
    for (std::size_t p = 1; p < places; ++p) {
      below[p] = below[p - 1], sines[p] = sines[p - 1];
      visit_interval(p, [&](double root, double weight) {
        const Values t = shares(root);
        for (std::size_t j = 0; j < rule::count; ++j) {
          sines[p][j] += weight * sine(root) * t[j];
          below[p][j] += weight * sine(root) * t[j] * root * root;
        }
      });
    }
    for (std::size_t p = 0; p < places; ++p) {
      const double root = double(p) / (places - 1), c = root * root;
      for (std::size_t j = 0; j < rule::count; ++j) {
        const double near = p > 0 ? below[p][j] / c : 0;
        of_values_[p][j] = float(2 * sine(root) * (near + sines.back()[j] - sines[p][j] - below.back()[j]));
      }
    }
    std::array<Values, rule::count> products{};
    for (std::size_t p = 1; p < places; ++p)
      visit_interval(p, [&](double root, double weight) {
        const Values t = shares(root);
        const double x = root * (places - 1) - double(p - 1);
        for (std::size_t j = 0; j < rule::count; ++j)
          for (std::size_t k = 0; k < rule::count; ++k)
            products[j][k] +=
                weight * 2 * root * root * t[j] * std::lerp(double(of_values_[p - 1][k]), double(of_values_[p][k]), x);
      });
    for (std::size_t j = 0; j < rule::count; ++j)
      for (std::size_t k = 0; k < rule::count; ++k) products_[j][k] = float(products[j][k]);
  }

  std::array<rule::Values, places> of_values_;
  std::array<rule::Values, rule::count> products_;
};

}  // namespace

RoughDiffuse::RoughDiffuse(float roughness, const rule::Values& passed, float cos_o)
    : roughness_(roughness), scale_(1 / (1 + steepness * roughness)) {
  const float mean = rule::mean(passed);
  const float to_share = mean > 0 ? 1 / (pi_f * mean) : 0;
  for (std::size_t i = 0; i < rule::count; ++i) passed_[i] = passed[i] * to_share;
  const float mean_lost = std::max(steepness - Excess::get().mean(passed_) * pi_f, 1e-3f);
  mean_kept_ = 1 - roughness_ * scale_ * mean_lost;
  second_ = roughness_ * lost(cos_o) / mean_lost;
}

// What the first lobe takes from a Lambertian in that direction below the layers, over its scale and roughness.
float RoughDiffuse::lost(float c) const { return std::max(0.f, steepness - Excess::get().at(c, passed_)); }

Spectrum RoughDiffuse::reflectance(const Spectrum& albedo, Vec3f wo, Vec3f wi) const {
  const float s = dot(wo, wi) - wo.z * wi.z;
  const float s_over_t = s > 0 ? s / std::max(wo.z, wi.z) : s;
  const Spectrum twice = albedo * albedo * mean_kept_ / (Spectrum(1.f) - albedo * (1 - mean_kept_));
  return (albedo * (1 + roughness_ * s_over_t) + twice * (second_ * lost(wi.z))) * (scale_ / pi_f);
}

}  // namespace meristem
