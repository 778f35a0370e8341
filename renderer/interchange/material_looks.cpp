#include "renderer/interchange/material_looks.h"

#include "renderer/materials/bsdf.h"
#include "renderer/materials/ggx.h"

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

Spectrum mixed(Spectrum a, Spectrum b, float t) { return a * (1 - t) + b * t; }

MaterialLook look_of(const BsdfParameters& bsdf) {
  MaterialLook look;
  const Spectrum dielectric = mixed(bsdf.diffuse + bsdf.transmitted, bsdf.glass_tint, bsdf.glass);
  look.base_color = mixed(dielectric, bsdf.metal_f0, bsdf.metalness);
  look.metalness = bsdf.metalness;
  look.roughness = std::sqrt(bsdf.alpha);
  // The surface itself: f0 is that of the surface under the coat
  look.ior = ggx::eta_of(bsdf.f0) * std::lerp(1.f, ggx::eta_of(bsdf.coat_f0), bsdf.coat);
  look.coat = bsdf.coat;
  look.coat_roughness = bsdf.coat > 0 ? std::sqrt(bsdf.coat_alpha) : 0;
  look.transmission = bsdf.glass;
  look.opacity = bsdf.opacity;
  look.emission = bsdf.emission;
  return look;
}

MaterialLook look_at(const Material& material, const FaceOrigin& origin, Vec3f position, Vec3f normal, Vec2f uv) {
  ShadingPoint point;
  point.hit.t = 0;
  point.hit.position = position;
  point.hit.geometric_normal = point.hit.shading_normal = point.wo = normal;
  point.hit.u = uv.x;
  point.hit.v = uv.y;
  point.hit.origin = origin;
  return look_of(material.evaluate(point));
}

}  // namespace

MaterialLooks::MaterialLooks(const Scene& scene) : scene_(scene), entries_(scene.materials.size()) {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    MaterialLook& look = entries_[i].look;
    if (scene.materials[i]->is_uniform())
      look = look_at(*scene.materials[i], FaceOrigin{}, {}, {0, 1, 0}, {});
    else
      look.varies = true;
    look.name = scene.names.materials[i];
  }
}

bool MaterialLooks::any_varies() const {
  return std::ranges::any_of(entries_, [](const Entry& e) { return e.look.varies; });
}

std::uint32_t MaterialLooks::material_of(const FaceOrigin& origin) const {
  return origin.material >= 0 && std::size_t(origin.material) < entries_.size() ? std::uint32_t(origin.material) : 0;
}

Spectrum MaterialLooks::color_at(const FaceOrigin& origin, Vec3f position, Vec3f normal, Vec2f uv) {
  const std::uint32_t index = material_of(origin);
  Entry& entry = entries_[index];
  MaterialLook& mean = entry.look;
  mean.is_used = true;
  if (!mean.varies) return mean.base_color;
  const MaterialLook look = look_at(*scene_.materials[index], origin, position, normal, uv);
  const auto share = float(1 / ++entry.samples);
  mean.base_color = mixed(mean.base_color, look.base_color, share);
  mean.metalness = std::lerp(mean.metalness, look.metalness, share);
  mean.roughness = std::lerp(mean.roughness, look.roughness, share);
  mean.ior = std::lerp(mean.ior, look.ior, share);
  mean.coat = std::lerp(mean.coat, look.coat, share);
  mean.coat_roughness = std::lerp(mean.coat_roughness, look.coat_roughness, share);
  mean.transmission = std::lerp(mean.transmission, look.transmission, share);
  mean.opacity = std::lerp(mean.opacity, look.opacity, share);
  mean.emission = mixed(mean.emission, look.emission, share);
  return look.base_color;
}

std::vector<MaterialLook> MaterialLooks::list() const {
  std::vector<MaterialLook> looks;
  for (const Entry& e : entries_) looks.push_back(e.look);
  return looks;
}

}  // namespace meristem
