#include "renderer/materials/bsdf.h"

#include "renderer/materials/fuzz.h"
#include "renderer/materials/ggx.h"
#include "renderer/materials/ggx_albedo.h"

namespace meristem {
namespace {

// Schlick's weight (1 - c)^5.
float schlick(float c) {
  const float m = 1 - std::clamp(c, 0.f, 1.f);
  return m * m * m * m * m;
}

// The shading normal bent towards wo just so far that wo lies above its horizon.
Vec3f visible_normal(Vec3f shading, Vec3f geometric, Vec3f wo) {
  constexpr float least = 1e-3f;
  if (!is_finite(shading) || !(dot(shading, geometric) > 0)) return geometric;
  const float cosine = dot(shading, wo);
  return cosine >= least ? shading : normalize(shading + wo * (least - cosine));
}

// EON, section 3: the directional albedo of the Fujii-Oren-Nayar lobe, from its exact integral (equation 12), and
// constants.
float fon_scale(float roughness) { return 1 / (1 + (0.5f - 2 / (3 * pi_f)) * roughness); }
float fon_albedo(float c, float roughness) {
  const float s = std::sqrt(std::max(0.f, 1 - c * c));
  const float g = s * (std::acos(std::min(c, 1.f)) - s * c) + 2.f / 3 * (s * c * (1 + s + s * s) / (1 + s) - s);
  return fon_scale(roughness) * (1 + roughness * g / pi_f);
}
float fon_mean_albedo(float roughness) { return fon_scale(roughness) * (1 + (2.f / 3 - 28 / (15 * pi_f)) * roughness); }

}  // namespace

void Bsdf::set_frame(const ShadingPoint& point) {
  const float side = dot(point.hit.geometric_normal, point.wo) < 0 ? -1.f : 1.f;
  geometric_normal_ = point.hit.geometric_normal * side;
  frame_ = Frame(visible_normal(point.hit.shading_normal * side, geometric_normal_, point.wo));
  inside_ = side < 0 && glass > 0 && !thin_walled;
  const float cosine = dot(frame_.n, point.wo);
  if (f0 > 0) specular_albedo_ = ggx::Albedo::dielectric(alpha, f0);
  if (coat > 0) coat_albedo_ = ggx::Albedo::dielectric(coat_alpha, coat_f0);
  reflected_o_ = specular_albedo(cosine);
  passed_o_ = layered() ? passed_by_layers(cosine) : 1;
  diffuse_mean_ = mean_of_diffuse();
  shares_ = shares(cosine);
}

// The mean over all directions, weighted by 2 c, of what reaches the diffuse base.
float Bsdf::mean_of_diffuse() const {
  if (!layered()) return f0 > 0 ? 1 - specular_albedo_.mean() : 1;
  // Gauss's rule over the root of c, in which albedos are smooth, with its weight of 4 c^(3/2)
  struct Node {
    float root, weight;
  };
  constexpr Node nodes[] = {{0.15227316f, 0.00224684f}, {0.33130046f, 0.02834126f}, {0.53241157f, 0.12210477f},
                            {0.72560278f, 0.27377313f}, {0.88161668f, 0.35320396f}, {0.97679535f, 0.22033003f}};
  float mean = 0;
  for (const Node& n : nodes) {
    const float c = n.root * n.root;
    mean += n.weight * passed_by_layers(c) * (1 - specular_albedo(c));
  }
  return mean;
}

Spectrum Bsdf::metal_fresnel(float cosine) const {
  const float c = std::clamp(cosine, 0.f, 1.f), m = 1 - c;
  constexpr float c82 = 1.f / 7, m82 = 6.f / 7;
  constexpr float m82_6 = m82 * m82 * m82 * m82 * m82 * m82;
  const Spectrum at_82 = lerp(metal_f0, Spectrum(1.f), schlick(c82));
  const Spectrum dip = at_82 * (Spectrum(1.f) - metal_f82) / (c82 * m82_6);
  return max(Spectrum{}, lerp(metal_f0, Spectrum(1.f), schlick(c)) - dip * (c * m * m * m * m * m * m)) * metal_weight;
}

// The integral of 2 c F(c): 1/21 for (1 - c)^5 and 1/126 for c (1 - c)^6.
Spectrum Bsdf::metal_mean_fresnel() const {
  constexpr float c82 = 1.f / 7, m82 = 6.f / 7;
  constexpr float m82_6 = m82 * m82 * m82 * m82 * m82 * m82;
  const Spectrum at_82 = lerp(metal_f0, Spectrum(1.f), schlick(c82));
  const Spectrum dip = at_82 * (Spectrum(1.f) - metal_f82) / (c82 * m82_6);
  return max(Spectrum{}, lerp(metal_f0, Spectrum(1.f), 1.f / 21) - dip / 126) * metal_weight;
}

Spectrum Bsdf::metal_interreflection(float cos_o, float cos_i) const {
  const auto white = ggx::Albedo::white(alpha);
  const float mean = white.mean(), lost = 1 - mean;
  if (!(lost > 1e-4f)) return {};
  const Spectrum f = metal_mean_fresnel();
  const Spectrum total = f * f * mean / (Spectrum(1.f) - f * lost);
  return total * ((1 - white.at(cos_o)) * (1 - white.at(cos_i)) / (pi_f * lost));
}

Spectrum Bsdf::fresnel(float cosine) const {
  Spectrum f;
  if (metalness < 1) f += dielectric_tint * (ggx::fresnel_dielectric(cosine, ggx::eta_of(f0)) * (1 - metalness));
  if (metalness > 0) f += metal_fresnel(cosine) * metalness;
  return f;
}

float Bsdf::specular_albedo(float c) const { return f0 > 0 ? specular_albedo_.at(c) : 0; }
float Bsdf::coat_albedo(float c) const { return coat > 0 ? coat * coat_albedo_.at(c) : 0; }
float Bsdf::fuzz_albedo(float c) const { return fuzz > 0 ? fuzz * fuzz::albedo(c, fuzz_roughness) : 0; }

// What reaches the diffuse base and comes back out, such that its cosine-weighted integral over wi is the part of wo
// that is not reflected above.
float Bsdf::over_diffuse(float cos_i) const {
  float passed = (1 - reflected_o_) * passed_o_ * (1 - specular_albedo(cos_i));
  if (layered()) passed *= passed_by_layers(cos_i);
  return passed / diffuse_mean_;
}

// A tint of the base for the paths in and out through the coat, which are longer the flatter they are.
Spectrum Bsdf::coat_color(float cos_o, float cos_i) const {
  if (!(coat > 0) || coat_tint == Spectrum(1.f)) return Spectrum(1.f);
  const float n = ggx::eta_of(coat_f0);
  auto path = [&](float c) { return 1 / std::sqrt(1 - (1 - c * c) / (n * n)); };
  const float exponent = 0.5f * (path(cos_o) + path(cos_i));
  Spectrum tint;
  for (int k = 0; k < 3; ++k) tint[k] = 1 - coat + coat * std::pow(coat_tint[k], exponent);
  return tint;
}

float Bsdf::eta() const {
  // an index of 1 would not refract at all, and has no rough lobe
  const float n = std::max(ggx::eta_of(f0), 1.01f);
  return inside_ ? 1 / n : n;
}

// A thin wall reflects again and again between its two faces.
float Bsdf::glass_fresnel(float cosine) const {
  const float f = ggx::fresnel_dielectric(cosine, eta());
  return thin_walled ? 2 * f / (1 + f) : f;
}

Spectrum Bsdf::diffuse_reflectance(Vec3f wo, Vec3f wi) const {
  if (diffuse_roughness == 0) return diffuse / pi_f;
  const float r = diffuse_roughness;
  const float s = dot(wo, wi) - wo.z * wi.z;
  const float s_over_t = s > 0 ? s / std::max(wo.z, wi.z) : s;
  const Spectrum single = diffuse * (fon_scale(r) * (1 + r * s_over_t) / pi_f);
  const float mean = fon_mean_albedo(r);
  const Spectrum multiple_albedo = diffuse * diffuse * mean / (Spectrum(1.f) - diffuse * (1 - mean));
  const float lost = (1 - fon_albedo(wo.z, r)) * (1 - fon_albedo(wi.z, r)) / (1 - mean);
  return single + multiple_albedo * (std::max(0.f, lost) / pi_f);
}

// Chiang, Li, Burley 2019, equation 3: a smooth fall to zero where the geometric horizon cuts the shading hemisphere.
float Bsdf::terminator(Vec3f wi) const {
  const float across = dot(frame_.n, wi) * dot(frame_.n, geometric_normal_);
  const float g = across > 0 ? std::min(1.f, dot(geometric_normal_, wi) / across) : 0;
  return g * (1 + g * (1 - g));
}

// What is lost between microfacets of glass, given back as in Turquin 2019.
float Bsdf::glass_gain(float cos_o) const {
  if (thin_walled) return 1 / ggx::Albedo::white(alpha).at(cos_o);
  return 1 / ggx::glass_albedo(cos_o, alpha, std::max(ggx::eta_of(f0), 1.01f), inside_);
}

Spectrum Bsdf::layers_reflected(Vec3f wo, Vec3f wi) const {
  Spectrum f;
  if (coat > 0) {
    const float cos_h = dot(wo, normalize(wo + wi));
    f += Spectrum(coat * (1 - fuzz_albedo(wo.z)) * ggx::fresnel_dielectric(cos_h, ggx::eta_of(coat_f0)) *
                  ggx::reflectance(wo, wi, coat_alpha));
  }
  if (fuzz > 0) f += fuzz_color * (fuzz * fuzz::reflectance(wo, wi, fuzz_roughness));
  return f;
}

// The BRDF, both directions on the side of wo.
Spectrum Bsdf::reflected(Vec3f wo, Vec3f wi) const {
  const float base = 1 - metalness;
  Spectrum f;
  if (mirrors()) {
    const float cos_h = dot(wo, normalize(wo + wi));
    Spectrum mirror = fresnel(cos_h);
    if (glass > 0) {
      const float gain = glass_gain(wo.z), opaque = ggx::fresnel_dielectric(cos_h, ggx::eta_of(f0));
      mirror += dielectric_tint * (base * glass * (glass_fresnel(cos_h) * gain - opaque));
    }
    f = mirror * (passed_o_ * ggx::reflectance(wo, wi, alpha));
  }
  if (base > 0 && glass < 1) f += diffuse_reflectance(wo, wi) * (base * (1 - glass) * over_diffuse(wi.z));
  if (metalness > 0) f += metal_interreflection(wo.z, wi.z) * (metalness * passed_o_);
  if (!layered()) return f;
  return f * coat_color(wo.z, wi.z) + layers_reflected(wo, wi);
}

// The part of the glass alone, white.
float Bsdf::glass_through(Vec3f wo, Vec3f wi) const {
  const float gain = glass_gain(wo.z);
  if (thin_walled) {
    const Vec3f mirrored{wi.x, wi.y, -wi.z};
    return gain * (1 - glass_fresnel(dot(wo, normalize(wo + mirrored)))) * ggx::reflectance(wo, mirrored, alpha);
  }
  const Vec3f h = ggx::refracting_normal(wo, wi, eta());
  return gain * (1 - glass_fresnel(dot(wo, h))) * ggx::transmittance(wo, wi, alpha, eta());
}

// The BTDF.
Spectrum Bsdf::passed_through(Vec3f wo, Vec3f wi) const {
  const float base = 1 - metalness;
  if (base == 0) return {};
  Spectrum f;
  if (transmitted != Spectrum{}) f = transmitted * (base * (1 - glass) * over_diffuse(-wi.z) / pi_f);
  if (glass > 0) f += glass_tint * (base * glass * passed_o_ * glass_through(wo, wi));
  return f * coat_color(wo.z, -wi.z);
}

Spectrum Bsdf::albedo() const {
  const Spectrum base = (diffuse + transmitted) * (1 - glass) + glass_tint * glass;
  return base * (1 - metalness) + metal_f0 * (metal_weight * metalness);
}

Spectrum Bsdf::evaluate(Vec3f wo_world, Vec3f wi_world) const {
  const Vec3f wo = frame_.to_local(wo_world), wi = frame_.to_local(wi_world);
  if (!same_side(wo_world) || !(wo.z > 0)) return {};
  if (!same_side(wi_world)) return wi.z < 0 ? passed_through(wo, wi) * -wi.z : Spectrum{};
  return wi.z > 0 ? reflected(wo, wi) * (wi.z * terminator(wi_world)) : Spectrum{};
}

}  // namespace meristem
