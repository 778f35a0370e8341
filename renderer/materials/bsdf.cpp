#include "renderer/materials/bsdf.h"

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
  const float mean = ggx::white_mean_albedo(alpha), lost = 1 - mean;
  if (!(lost > 1e-4f)) return {};
  const Spectrum f = metal_mean_fresnel();
  const Spectrum total = f * f * mean / (Spectrum(1.f) - f * lost);
  return total * ((1 - ggx::white_albedo(cos_o, alpha)) * (1 - ggx::white_albedo(cos_i, alpha)) / (pi_f * lost));
}

Spectrum Bsdf::fresnel(float cosine) const {
  Spectrum f;
  if (metalness < 1) f += dielectric_tint * (ggx::fresnel_dielectric(cosine, ggx::eta_of(f0)) * (1 - metalness));
  if (metalness > 0) f += metal_fresnel(cosine) * metalness;
  return f;
}

// What reaches the base and comes back out, such that its cosine-weighted integral over wi is 1 - albedo(wo).
float Bsdf::through_dielectric(float cos_o, float cos_i) const {
  if (f0 == 0) return 1;
  const float out = 1 - ggx::dielectric_albedo(cos_o, alpha, f0), in = 1 - ggx::dielectric_albedo(cos_i, alpha, f0);
  return out * in / (1 - ggx::dielectric_mean_albedo(alpha, f0));
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

Spectrum Bsdf::evaluate(Vec3f wo_world, Vec3f wi_world) const {
  const Vec3f wo = frame_.to_local(wo_world), wi = frame_.to_local(wi_world);
  if (!same_side(wo_world) || !(wo.z > 0)) return {};
  const float base = 1 - metalness;
  if (!same_side(wi_world)) {
    if (!(wi.z < 0) || base == 0) return {};
    return transmitted * (base * through_dielectric(wo.z, -wi.z) * -wi.z / pi_f);
  }
  if (!(wi.z > 0)) return {};
  const float cos_h = dot(wo, normalize(wo + wi));
  Spectrum f = fresnel(cos_h) * ggx::reflectance(wo, wi, alpha);
  if (base > 0) f += diffuse_reflectance(wo, wi) * (base * through_dielectric(wo.z, wi.z));
  if (metalness > 0) f += metal_interreflection(wo.z, wi.z) * metalness;
  return f * (wi.z * terminator(wi_world));
}

// Lobes are picked by their albedos, estimated.
Bsdf::Shares Bsdf::shares(float cosine) const {
  const float base = 1 - metalness;
  const float reflected = f0 > 0 ? ggx::dielectric_albedo(cosine, alpha, f0) : 0;
  Shares s;
  s.specular = base * reflected * luminance(dielectric_tint);
  s.diffuse = base * (1 - reflected) * luminance(diffuse);
  s.transmitted = base * (1 - reflected) * luminance(transmitted);
  if (metalness > 0) {
    const float lost = 1 - ggx::white_albedo(cosine, alpha), f = metalness * luminance(metal_fresnel(cosine));
    s.specular += f * (1 - lost);
    s.diffuse += f * lost;
  }
  const float sum = s.specular + s.diffuse + s.transmitted;
  if (!(sum > 0)) return {};
  return {s.specular / sum, s.diffuse / sum, s.transmitted / sum};
}

float Bsdf::pdf(Vec3f wo_world, Vec3f wi_world) const {
  const Vec3f wo = frame_.to_local(wo_world), wi = frame_.to_local(wi_world);
  if (!same_side(wo_world) || !(wo.z > 0)) return 0;
  const Shares s = shares(wo.z);
  if (!same_side(wi_world)) return wi.z < 0 ? s.transmitted * -wi.z / pi_f : 0;
  if (!(wi.z > 0)) return 0;
  return s.specular * ggx::reflected_pdf(wo, wi, alpha) + s.diffuse * wi.z / pi_f;
}

BsdfSample Bsdf::sample(Vec3f wo_world, Vec2f random, float choice) const {
  const Vec3f wo = frame_.to_local(wo_world);
  BsdfSample result;
  if (!same_side(wo_world) || !(wo.z > 0)) return result;
  const Shares s = shares(wo.z);
  Vec3f wi;
  if (choice < s.specular) {
    const Vec3f h = ggx::sample_visible_normal(wo, alpha, random);
    wi = h * (2 * dot(wo, h)) - wo;
  } else {
    wi = cosine_hemisphere(random);
    result.is_transmission = choice >= s.specular + s.diffuse && s.transmitted > 0;
    if (result.is_transmission) wi.z = -wi.z;
  }
  result.wi = normalize(frame_.to_world(wi));
  if (same_side(result.wi) == result.is_transmission) return result;
  const float density = pdf(wo_world, result.wi);
  if (!(density > 0)) return result;
  const Spectrum weight = evaluate(wo_world, result.wi) / density;
  if (!is_finite(weight)) return result;
  result.pdf = density;
  result.weight = weight;
  return result;
}

}  // namespace meristem
