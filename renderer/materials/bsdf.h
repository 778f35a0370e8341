// Bsdf: the scattering of one hit: made by a material of parameters that it has evaluated, asked by an integrator.
// Immutable; lives on the stack; no allocation. Directions are unit, in world space, away from the surface.
//
// Lobes, for a surface that is `metalness` metal and otherwise a dielectric over a diffuse base:
//  - GGX reflection (ggx.h) with the exact dielectric Fresnel term, or for metal the F82-tint of Kutz, Hasan,
//    Edmondson 2021, "Novel Aspects of the Adobe Standard Material", section 2.3;
//  - for metal, the light that scatters between microfacets: Kulla and Conty 2017, "Revisiting Physically Based
//    Shading";
//  - diffuse reflection, Lambert or, with diffuse_roughness, EON (rough_diffuse.h), and diffuse transmission (Lambert),
//    both dimmed by what the dielectric has reflected on the way in and out, such that a white base under it gives back
//    all light (Kelemen, Szirmay-Kalos 2001).
//
//  - glass in place of the diffuse base: GGX reflection and refraction with one distribution of microfacets (Walter et
//    al. 2007), or through a thin wall straight on; tinted; what is lost between microfacets is given back by a factor
//    that depends on wo (Turquin 2019, "Practical multiple scattering compensation for microfacet models");
//  - on top of all of it a coat (GGX, dielectric) and on top of that fuzz (fuzz.h). A layer passes on what it does not
//    reflect: below it specular lobes are dimmed by what it passes of wo, diffuse ones by the product of that and what
//    it passes of wi, such that a white base gives back all that arrives.
//
// Which side a direction lies on is decided by the geometric normal; cosines use the shading normal, bent towards wo
// where it would face away. Directions that the two normals see on different sides scatter nothing, so no light leaks;
// towards that border reflection fades as in Chiang, Li, Burley 2019, "Taming the Shadow Terminator". With equal
// normals it conserves energy and is reciprocal but for what depends on wo alone: the factor of glass (and its eta^2),
// the dimming of specular lobes by layers. Finite for every finite input; parameters must be in the ranges given.
#pragma once

#include "renderer/materials/fuzz.h"
#include "renderer/materials/ggx_albedo.h"
#include "renderer/materials/rough_diffuse.h"
#include "renderer/scene/interfaces.h"
#include "renderer/scene/warps.h"

namespace meristem {

// Colours lie in [0, 1].
struct BsdfParameters {
  Spectrum diffuse{0.8f, 0.8f, 0.8f};  // albedo of diffuse reflection
  Spectrum transmitted{};              // albedo of diffuse transmission; diffuse + transmitted <= 1
  float diffuse_roughness = 0;         // [0, 1]
  float metalness = 0;                 // [0, 1]
  float alpha = 0.09f;                 // GGX, [ggx::min_alpha, 1]
  float f0 = 0.04f;                    // dielectric reflectance at normal incidence, [0, ggx::max_f0]
  Spectrum dielectric_tint{1, 1, 1};   // multiplies the dielectric reflection
  Spectrum metal_f0{};                 // metal reflectance at normal incidence
  Spectrum metal_f82{1, 1, 1};         // tint at 82 degrees
  float metal_weight = 1;              // multiplies the metal reflection
  float glass = 0;                     // [0, 1]: which part of the dielectric's base is glass
  Spectrum glass_tint{1, 1, 1};        // multiplies what goes through
  Spectrum absorption{};               // of the glass inside, per metre
  bool thin_walled = false;            // glass without inside
  float coat = 0;                      // [0, 1]
  float coat_alpha = 1e-3f;            // GGX, as alpha
  float coat_f0 = 0.053f;              // [0, ggx::max_f0]
  Spectrum coat_tint{1, 1, 1};         // of light that goes in and out again straight
  float fuzz = 0;                      // [0, 1]
  Spectrum fuzz_color{1, 1, 1};        // multiplies its reflection
  float fuzz_roughness = 0.5f;         // [fuzz::min_roughness, 1]
  float opacity = 1;                   // probability that light meets the surface at all
  Spectrum emission{};                 // radiance, all directions, both sides

  // Nothing but Lambert's law on both sides: only cosines matter.
  bool is_lambertian() const {
    return !(f0 > 0 || metalness > 0 || glass > 0 || coat > 0 || fuzz > 0 || diffuse_roughness > 0);
  }
};

class Bsdf : public BsdfParameters {
 public:
  // For light that leaves the point towards point.wo.
  Bsdf(const BsdfParameters& parameters, const ShadingPoint& point);

  // Whether light comes through from the other side.
  bool transmits() const { return transmitted != Spectrum{} || glass > 0; }
  // Whether wo lies inside the glass.
  bool inside() const { return inside_; }
  // What it gives back of white light, roughly and without directions: the base and the metal, not what lies over
  // them. For AOVs.
  Spectrum albedo() const;

  // What it scatters from wi to wo. Here and below wo is that of the point.
  struct Scattered {
    Spectrum value;  // times |cos| of wi
    float pdf = 0;   // the density of sample() by solid angle
  };
  Scattered scattered(Vec3f wo, Vec3f wi) const;
  Spectrum evaluate(Vec3f wo, Vec3f wi) const { return scattered(wo, wi).value; }
  float pdf(Vec3f wo, Vec3f wi) const { return scattered(wo, wi).pdf; }
  // `choice` picks the lobe, `random` the direction in it. pdf 0: absorbed.
  BsdfSample sample(Vec3f wo, Vec2f random, float choice) const;

 private:
  struct Shares {
    float specular = 0, diffuse = 0, transmitted = 0, glass = 0, coat = 0, fuzz = 0;  // sum to 1, or all 0
    float sum() const { return specular + diffuse + transmitted + glass + coat + fuzz; }
    Shares operator*(float scale) const {
      return {specular * scale, diffuse * scale, transmitted * scale, glass * scale, coat * scale, fuzz * scale};
    }
  };
  struct Choice {
    Vec3f wi;  // zero: absorbed
    bool transmission = false;
  };
  Shares albedos(float cosine) const;
  Spectrum fresnel(float cosine) const;
  Spectrum metal_fresnel(float cosine) const;
  Spectrum metal_interreflection(float cos_o, float cos_i) const;
  Spectrum metal_mean_fresnel() const;
  hemisphere_rule::Values passed_to_base() const;
  // The parts that the dielectric and the layers over it reflect; what passes those layers, of colour left out.
  float specular_albedo(float c) const;
  float coat_albedo(float c) const;
  float fuzz_albedo(float c) const;
  float passed_by_layers(float c) const { return (1 - coat_albedo(c)) * (1 - fuzz_albedo(c)); }
  bool layered() const { return coat > 0 || fuzz > 0; }
  bool mirrors() const { return f0 > 0 || metalness > 0 || glass > 0; }  // below the layers
  float over_diffuse(float cos_i) const;
  Spectrum coat_color(float cos_o, float cos_i) const;
  float eta() const;  // of the glass, from the side of wo
  float glass_fresnel(float cosine) const;
  float glass_gain(float cos_o) const;
  void set_lobes(float cosine);  // of wo
  Scattered lambertian(float cos_i) const;
  // Without the cosine of wi; directions in world space.
  Scattered by_lobes(Vec3f wo, Vec3f wi, bool reflects) const;
  Scattered reflected(Vec3f wo, Vec3f wi) const;
  Scattered layers_reflected(Vec3f wo, Vec3f wi) const;
  Scattered passed_through(Vec3f wo, Vec3f wi) const;
  Scattered glass_through(Vec3f wo, Vec3f wi) const;
  Choice choose_diffuse(Vec2f random, float choice) const;
  Choice choose(Vec3f wo, Vec2f random, float choice) const;  // wo in world space
  Choice choose_glass(Vec3f wo, Vec2f random, float choice) const;
  Spectrum diffuse_reflectance(Vec3f wo, Vec3f wi) const;
  float terminator(Vec3f wi) const;
  bool same_side(Vec3f w) const { return dot(w, geometric_normal_) > 0; }

  Vec3f geometric_normal_{0, 0, 1};            // on the side of wo
  Frame frame_;                                // around the shading normal, on the side of wo
  bool inside_ = false;                        // wo is where the glass is
  bool is_lambertian_;                         // is_lambertian()
  bool sees_;                                  // wo lies above both normals: else nothing is scattered
  ggx::Albedo specular_albedo_, coat_albedo_;  // of the dielectric if f0 > 0, of the coat if there is one
  fuzz::Fibers fibers_;                        // if there is fuzz
  RoughDiffuse rough_;                         // if the base is rough
  // Of wo: what the dielectric reflects, what the layers above it pass, and the lobes' shares of samples
  float reflected_o_ = 0, passed_o_ = 1;
  Shares shares_;
  float diffuse_mean_ = 1;  // the mean over all directions of what reaches the diffuse base
};

// Chiang, Li, Burley 2019, equation 3: a smooth fall to zero where the geometric horizon cuts the shading hemisphere.
inline float Bsdf::terminator(Vec3f wi) const {
  const float across = dot(frame_.n, wi) * dot(frame_.n, geometric_normal_);
  const float g = across > 0 ? std::min(1.f, dot(geometric_normal_, wi) / across) : 0;
  return g * (1 + g * (1 - g));
}

inline Bsdf::Scattered Bsdf::lambertian(float cos_i) const {
  if (cos_i > 0) return {diffuse / pi_f, shares_.diffuse * cos_i / pi_f};
  return {transmitted / pi_f, shares_.transmitted * -cos_i / pi_f};
}

inline Bsdf::Scattered Bsdf::scattered(Vec3f wo, Vec3f wi) const {
  const float cos_i = dot(frame_.n, wi);
  const bool reflects = same_side(wi);
  if (!sees_ || (reflects ? !(cos_i > 0) : !(cos_i < 0))) return {};
  Scattered s = is_lambertian_ ? lambertian(cos_i) : by_lobes(wo, wi, reflects);
  s.value *= reflects ? cos_i * terminator(wi) : -cos_i;
  return s;
}

inline Bsdf::Choice Bsdf::choose_diffuse(Vec2f random, float choice) const {
  const Vec3f wi = cosine_hemisphere(random);
  if (choice < shares_.diffuse + shares_.fuzz || !(shares_.transmitted > 0)) return {wi, false};
  return {{wi.x, wi.y, -wi.z}, true};
}

inline BsdfSample Bsdf::sample(Vec3f wo, Vec2f random, float choice) const {
  BsdfSample result;
  if (!sees_) return result;
  const Choice chosen = is_lambertian_ ? choose_diffuse(random, choice) : choose(wo, random, choice);
  if (chosen.wi == Vec3f{}) return result;
  result.is_transmission = chosen.transmission;
  result.wi = normalize(frame_.to_world(chosen.wi));
  if (same_side(result.wi) == result.is_transmission) return result;
  const auto [value, density] = scattered(wo, result.wi);
  if (!(density > 0)) return result;
  const Spectrum weight = value / density;
  if (!is_finite(weight)) return result;
  if (result.is_transmission && glass > 0 && !thin_walled) result.eta = eta();
  result.pdf = density;
  result.weight = weight;
  return result;
}

}  // namespace meristem
