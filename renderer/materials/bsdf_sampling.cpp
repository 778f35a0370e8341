// Which lobe of a Bsdf is sampled, and where; bsdf.cpp is its scattering.
#include "renderer/materials/bsdf.h"
#include "renderer/materials/ggx.h"
#include "renderer/materials/ggx_albedo.h"

namespace meristem {

// Of the lobes, estimated: they are picked by these.
Bsdf::Shares Bsdf::albedos(float cosine) const {
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
  return s;
}

// One microfacet reflects or refracts, by its Fresnel term.
Bsdf::Choice Bsdf::choose_glass(Vec3f wo, Vec2f random, float choice) const {
  const Vec3f h = ggx::sample_visible_normal(wo, alpha, random), mirrored = h * (2 * dot(wo, h)) - wo;
  if (choice < glass_fresnel(dot(wo, h))) return {mirrored, false};
  if (thin_walled) return {{mirrored.x, mirrored.y, -mirrored.z}, true};
  return {ggx::refract(wo, h, eta()), true};
}

Bsdf::Choice Bsdf::choose(Vec3f wo_world, Vec2f random, float choice) const {
  const Vec3f wo = frame_.to_local(wo_world);
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
  return choose_diffuse(random, choice);
}

}  // namespace meristem
