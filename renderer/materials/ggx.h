// GGX microfacets: isotropic, in a local frame with z along the normal; directions unit, with z > 0 unless said
// otherwise.
//
// Distribution and masking: Walter et al. 2007, "Microfacet Models for Refraction"; height-correlated Smith term and
// reflected density: Heitz 2014, "Understanding the Masking-Shadowing Function", sections 5 and 6.
// alpha is the squared roughness. Pure functions; any thread.
#pragma once

#include "geometry/base/vec.h"

namespace meristem::ggx {

constexpr float min_alpha = 1e-3f;  // below it float directions no longer resolve the peak

// Density of microfacet normals; its integral of D(h) h.z is 1.
float distribution(Vec3f h, float alpha);
float lambda(Vec3f w, float alpha);
inline float masking(Vec3f w, float alpha) { return 1 / (1 + lambda(w, alpha)); }
// Both ways at once, height-correlated.
inline float masking_shadowing(Vec3f wo, Vec3f wi, float alpha) {
  return 1 / (1 + lambda(wo, alpha) + lambda(wi, alpha));
}

// What microfacets with the normal h, half way between wo and wi, reflect.
struct Reflection {
  float reflectance = 0;  // D G / (4 cos cos): a BRDF but for the Fresnel term
  float pdf = 0;          // by solid angle, of the mirror directions of sample_visible_normal()
};
Reflection reflection(Vec3f wo, Vec3f wi, Vec3f h, float alpha);
// The normal of a microfacet that wo sees. Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps".
Vec3f sample_visible_normal(Vec3f wo, float alpha, Vec2f random);

// Refraction from wo into a medium of relative index eta (below 1: into the thinner one); wi.z < 0. Walter et al.,
// section 5.3. `h` is the normal (h.z > 0) of a microfacet that refracts wo to wi; zero if there is none.
Vec3f refracting_normal(Vec3f wo, Vec3f wi, float eta);
// The direction to which a microfacet refracts wo; zero for total reflection.
Vec3f refract(Vec3f wo, Vec3f h, float eta);
// A BTDF of radiance, but for the Fresnel term, and the density of the refracted directions of visible normals.
float transmittance(Vec3f wo, Vec3f wi, float alpha, float eta);
float refracted_pdf(Vec3f wo, Vec3f wi, float alpha, float eta);

// Unpolarised Fresnel reflectance at an interface to a medium of relative index eta; 1 for total reflection.
float fresnel_dielectric(float cosine, float eta);
// eta from the reflectance at normal incidence in [0, 1), and back.
float eta_of(float f0);
float f0_of(float eta);
// The largest f0 of a material: eta = 4.
constexpr float max_f0 = 0.36f;

}  // namespace meristem::ggx
