// The sampling half of Bsdf; bsdf.cpp is its scattering.
#include "renderer/materials/bsdf.h"
#include "renderer/materials/ggx.h"
#include "renderer/materials/ggx_albedo.h"

namespace meristem {

// Lobes are picked by their albedos, estimated.
Bsdf::Shares Bsdf::shares(float cosine) const {
  const float base = 1 - metalness;
  Shares s;
  s.specular = base * (1 - glass) * reflected_o_ * luminance(dielectric_tint);
  s.diffuse = base * (1 - glass) * (1 - reflected_o_) * luminance(diffuse);
  s.transmitted = base * (1 - glass) * (1 - reflected_o_) * luminance(transmitted);
  s.glass = base * glass * std::max(luminance(glass_tint), reflected_o_);
  if (metalness > 0) {
    const float lost = 1 - ggx::Albedo::white(alpha).at(cosine), f = metalness * luminance(metal_fresnel(cosine));
    s.specular += f * (1 - lost);
    s.diffuse += f * lost;
  }
  if (layered()) {
    s.specular *= passed_o_, s.diffuse *= passed_o_, s.transmitted *= passed_o_, s.glass *= passed_o_;
    s.coat = coat_albedo(cosine) * (1 - fuzz_albedo(cosine));
    s.fuzz = fuzz_albedo(cosine) * luminance(fuzz_color);
  }
  const float scale = s.sum() > 0 ? 1 / s.sum() : 0;
  return {s.specular * scale, s.diffuse * scale, s.transmitted * scale,
          s.glass * scale,    s.coat * scale,    s.fuzz * scale};
}

// One microfacet reflects or refracts, by its Fresnel term.
Bsdf::Choice Bsdf::choose_glass(Vec3f wo, Vec2f random, float choice) const {
  const Vec3f h = ggx::sample_visible_normal(wo, alpha, random), mirrored = h * (2 * dot(wo, h)) - wo;
  if (choice < glass_fresnel(dot(wo, h))) return {mirrored, false};
  if (thin_walled) return {{mirrored.x, mirrored.y, -mirrored.z}, true};
  return {ggx::refract(wo, h, eta()), true};
}

Bsdf::Choice Bsdf::choose(Vec3f wo, Vec2f random, float choice) const {
  const Shares& s = shares_;
  auto mirrored = [&](float roughness) {
    const Vec3f h = ggx::sample_visible_normal(wo, roughness, random);
    return h * (2 * dot(wo, h)) - wo;
  };
  // Each lobe takes its share of [0, 1) and passes on the rest
  auto picked = [&](float share) {
    if (choice < share) return true;
    choice -= share;
    return false;
  };
  if (picked(s.specular)) return {mirrored(alpha), false};
  if (picked(s.glass)) return choose_glass(wo, random, choice / s.glass);
  if (picked(s.coat)) return {mirrored(coat_alpha), false};
  const Vec3f wi = cosine_hemisphere(random);
  if (picked(s.diffuse + s.fuzz) || !(s.transmitted > 0)) return {wi, false};
  return {{wi.x, wi.y, -wi.z}, true};
}

BsdfSample Bsdf::sample(Vec3f wo_world, Vec2f random, float choice) const {
  const Vec3f wo = frame_.to_local(wo_world);
  BsdfSample result;
  if (!same_side(wo_world) || !(wo.z > 0)) return result;
  const Choice chosen = choose(wo, random, choice);
  if (chosen.wi == Vec3f{}) return result;
  result.is_transmission = chosen.transmission;
  result.wi = normalize(frame_.to_world(chosen.wi));
  if (same_side(result.wi) == result.is_transmission) return result;
  const auto [value, density] = scattered(wo_world, result.wi);
  if (!(density > 0)) return result;
  const Spectrum weight = value / density;
  if (!is_finite(weight)) return result;
  if (result.is_transmission && glass > 0 && !thin_walled) result.eta = eta();
  result.pdf = density;
  result.weight = weight;
  return result;
}

}  // namespace meristem
