#include "renderer/materials/ggx.h"

#include "renderer/scene/warps.h"

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

Reflection reflection(Vec3f wo, Vec3f wi, Vec3f h, float alpha) {
  if (!(wo.z > min_cosine && wi.z > min_cosine)) return {};
  const float d = distribution(h, alpha), lambda_o = lambda(wo, alpha);
  return {d * (1 / (1 + lambda_o + lambda(wi, alpha))) / (4 * wo.z * wi.z), 1 / (1 + lambda_o) * d / (4 * wo.z)};
}

Vec3f sample_visible_normal(Vec3f wo, float alpha, Vec2f random) {
  const Vec3f v = normalize(Vec3f{alpha * wo.x, alpha * wo.y, wo.z});
  const float angle = 2 * pi_f * random.x;
  const float z = (1 - random.y) * (1 + v.z) - v.z;
  const float sine = std::sqrt(std::clamp(1 - z * z, 0.f, 1.f));
  const Vec3f h = Vec3f{sine * std::cos(angle), sine * std::sin(angle), z} + v;
  return normalize(Vec3f{alpha * h.x, alpha * h.y, std::max(h.z, 1e-9f)});
}

Vec3f refracting_normal(Vec3f wo, Vec3f wi, float eta) {
  Vec3f h = normalize(wo + wi * eta);
  if (h.z < 0) h = -h;
  return dot(h, wo) > 0 && dot(h, wi) < 0 ? h : Vec3f{};
}

Vec3f refract(Vec3f wo, Vec3f h, float eta) {
  const float c = dot(wo, h), s2 = (1 - c * c) / (eta * eta);
  if (!(s2 < 1)) return {};
  return normalize(h * (c / eta - std::sqrt(1 - s2)) - wo / eta);
}

namespace {

// d(normal) / d(wi) of refraction, but for |dot(wi, h)|.
float refraction_jacobian(Vec3f wo, Vec3f wi, Vec3f h, float eta) {
  const float root = dot(wi, h) + dot(wo, h) / eta;
  return 1 / std::max(root * root, 1e-12f);
}

}  // namespace

// The radiance that goes to the thinner medium spreads: 1 / eta^2.
float transmittance(Vec3f wo, Vec3f wi, float alpha, float eta) {
  if (!(wo.z > min_cosine && wi.z < -min_cosine)) return 0;
  const Vec3f h = refracting_normal(wo, wi, eta);
  if (h == Vec3f{}) return 0;
  const float cosines = dot(wo, h) * -dot(wi, h) / (wo.z * -wi.z);
  return distribution(h, alpha) * masking_shadowing(wo, {wi.x, wi.y, -wi.z}, alpha) * cosines *
         refraction_jacobian(wo, wi, h, eta) / (eta * eta);
}

float refracted_pdf(Vec3f wo, Vec3f wi, float alpha, float eta) {
  if (!(wo.z > min_cosine && wi.z < -min_cosine)) return 0;
  const Vec3f h = refracting_normal(wo, wi, eta);
  if (h == Vec3f{}) return 0;
  return masking(wo, alpha) * distribution(h, alpha) * dot(wo, h) / wo.z * -dot(wi, h) *
         refraction_jacobian(wo, wi, h, eta);
}

float fresnel_dielectric(float cosine, float eta) {
  const float c = std::clamp(cosine, 0.f, 1.f);
  const float ct2 = 1 - (1 - c * c) / (eta * eta);
  if (!(ct2 > 0)) return 1;
  const float ct = std::sqrt(ct2);
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

}  // namespace meristem::ggx
