#include "renderer/materials/bsdf.h"

#include "renderer/materials/ggx.h"
#include "renderer/materials/ggx_albedo.h"
#include "renderer/materials/glass_albedo.h"

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

}  // namespace

Bsdf::Bsdf(const BsdfParameters& parameters, const ShadingPoint& point)
    : BsdfParameters(parameters), is_lambertian_(is_lambertian()) {
  const float side = dot(point.hit.geometric_normal, point.wo) < 0 ? -1.f : 1.f;
  geometric_normal_ = point.hit.geometric_normal * side;
  frame_ = Frame(visible_normal(point.hit.shading_normal * side, geometric_normal_, point.wo));
  inside_ = side < 0 && glass > 0 && !thin_walled;
  const float cosine = dot(frame_.n, point.wo);
  sees_ = same_side(point.wo) && cosine > 0;
  Shares estimates;
  if (is_lambertian_) {
    estimates.diffuse = luminance(diffuse);
    estimates.transmitted = luminance(transmitted);
  } else {
    set_lobes(cosine);
    estimates = albedos(cosine);
  }
  const float sum = estimates.sum();
  shares_ = estimates * (sum > 0 ? 1 / sum : 0);
}

void Bsdf::set_lobes(float cosine) {
  if (f0 > 0) specular_albedo_ = ggx::Albedo::dielectric(alpha, f0);
  if (fuzz > 0) fibers_ = fuzz::Fibers(fuzz_roughness);
  if (coat > 0) coat_albedo_ = ggx::Albedo::dielectric(coat_alpha, coat_f0);
  reflected_o_ = specular_albedo(cosine);
  passed_o_ = layered() ? passed_by_layers(cosine) : 1;
  if (layered() || diffuse_roughness > 0) {
    const hemisphere_rule::Values passed = passed_to_base();
    diffuse_mean_ = hemisphere_rule::mean(passed);
    if (diffuse_roughness > 0) rough_ = RoughDiffuse(diffuse_roughness, passed, cosine);
  } else {
    diffuse_mean_ = f0 > 0 ? 1 - specular_albedo_.mean() : 1;
  }
}

// What the dielectric and the layers over it let pass to the base.
hemisphere_rule::Values Bsdf::passed_to_base() const {
  hemisphere_rule::Values passed;
  passed.fill(1);
  auto dim = [&](const hemisphere_rule::Values& albedos, float weight) {
    for (std::size_t i = 0; i < passed.size(); ++i) passed[i] *= 1 - weight * albedos[i];
  };
  if (f0 > 0) dim(specular_albedo_.at_rule(), 1);
  if (coat > 0) dim(coat_albedo_.at_rule(), coat);
  if (fuzz > 0) dim(fibers_.albedo_at_rule(), fuzz);
  return passed;
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
float Bsdf::fuzz_albedo(float c) const { return fuzz > 0 ? fuzz * fibers_.albedo(c) : 0; }

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
  return diffuse_roughness > 0 ? rough_.reflectance(diffuse, wo, wi) : diffuse / pi_f;
}

// What is lost between microfacets of glass, given back as in Turquin 2019.
float Bsdf::glass_gain(float cos_o) const {
  if (thin_walled) return 1 / ggx::Albedo::white(alpha).at(cos_o);
  return 1 / ggx::glass_albedo(cos_o, alpha, eta());
}

// Both directions on the side of wo: the BRDF.
Bsdf::Scattered Bsdf::layers_reflected(Vec3f wo, Vec3f wi) const {
  Scattered s;
  if (coat > 0) {
    const Vec3f h = normalize(wo + wi);
    const ggx::Reflection r = ggx::reflection(wo, wi, h, coat_alpha);
    s.value += Spectrum(coat * (1 - fuzz_albedo(wo.z)) * ggx::fresnel_dielectric(dot(wo, h), ggx::eta_of(coat_f0)) *
                        r.reflectance);
    s.pdf = shares_.coat * r.pdf;
  }
  if (fuzz > 0) s.value += fuzz_color * (fuzz * fibers_.reflectance(wo, wi));
  return s;
}

Bsdf::Scattered Bsdf::reflected(Vec3f wo, Vec3f wi) const {
  const float base = 1 - metalness;
  Scattered s{{}, (shares_.diffuse + shares_.fuzz) * wi.z / pi_f};
  if (mirrors()) {
    const Vec3f h = normalize(wo + wi);
    const float cos_h = dot(wo, h);
    const ggx::Reflection r = ggx::reflection(wo, wi, h, alpha);
    Spectrum mirror = fresnel(cos_h);
    float share = shares_.specular;
    if (glass > 0) {
      const float of_glass = glass_fresnel(cos_h), opaque = ggx::fresnel_dielectric(cos_h, ggx::eta_of(f0));
      mirror += dielectric_tint * (base * glass * (of_glass * glass_gain(wo.z) - opaque));
      share += shares_.glass * of_glass;
    }
    s.value = mirror * (passed_o_ * r.reflectance);
    s.pdf += share * r.pdf;
  }
  if (base > 0 && glass < 1) s.value += diffuse_reflectance(wo, wi) * (base * (1 - glass) * over_diffuse(wi.z));
  if (metalness > 0) s.value += metal_interreflection(wo.z, wi.z) * (metalness * passed_o_);
  if (!layered()) return s;
  const Scattered layers = layers_reflected(wo, wi);
  return {s.value * coat_color(wo.z, wi.z) + layers.value, s.pdf + layers.pdf};
}

// The part of the glass alone, white.
Bsdf::Scattered Bsdf::glass_through(Vec3f wo, Vec3f wi) const {
  const float gain = glass_gain(wo.z);
  if (thin_walled) {
    const Vec3f mirrored{wi.x, wi.y, -wi.z}, h = normalize(wo + mirrored);
    const float passed = 1 - glass_fresnel(dot(wo, h));
    const ggx::Reflection r = ggx::reflection(wo, mirrored, h, alpha);
    return {Spectrum(gain * passed * r.reflectance), shares_.glass * passed * r.pdf};
  }
  const float passed = 1 - glass_fresnel(dot(wo, ggx::refracting_normal(wo, wi, eta())));
  return {Spectrum(gain * passed * ggx::transmittance(wo, wi, alpha, eta())),
          shares_.glass * passed * ggx::refracted_pdf(wo, wi, alpha, eta())};
}

// The BTDF.
Bsdf::Scattered Bsdf::passed_through(Vec3f wo, Vec3f wi) const {
  const float base = 1 - metalness;
  if (base == 0) return {};
  Scattered s{{}, shares_.transmitted * -wi.z / pi_f};
  if (transmitted != Spectrum{}) s.value = transmitted * (base * (1 - glass) * over_diffuse(-wi.z) / pi_f);
  if (glass > 0) {
    const Scattered through = glass_through(wo, wi);
    s.value += glass_tint * (base * glass * passed_o_ * through.value.x);
    s.pdf += through.pdf;
  }
  s.value *= coat_color(wo.z, -wi.z);
  return s;
}

Spectrum Bsdf::albedo() const {
  const Spectrum base = (diffuse + transmitted) * (1 - glass) + glass_tint * glass;
  return base * (1 - metalness) + metal_f0 * (metal_weight * metalness);
}

Bsdf::Scattered Bsdf::by_lobes(Vec3f wo_world, Vec3f wi_world, bool reflects) const {
  const Vec3f wo = frame_.to_local(wo_world), wi = frame_.to_local(wi_world);
  return reflects ? reflected(wo, wi) : passed_through(wo, wi);
}

}  // namespace meristem
