// RoughDiffuse: diffuse reflection by a rough base, below layers that dim what enters and what leaves.
//
// Alone it is EON (Portsmouth, Kutz, Hill 2024, "EON: A Practical Energy-Preserving Rough Diffuse BRDF"): the lobe of
// Fujii, Oren and Nayar, and a second one, made of its directional albedo, that gives back what the first loses. Layers
// dim grazing light, to which the first lobe scatters more than a Lambertian does: below them it gives back less of
// what enters aslant than alone. Here the second lobe is made of the albedo that the first has below the layers, so
// that a white base gives back all that enters; both lobes are reciprocal. A small value; any thread.
#pragma once

#include "renderer/materials/hemisphere_rule.h"
#include "renderer/scene/interfaces.h"

namespace meristem {

class RoughDiffuse {
 public:
  RoughDiffuse() = default;  // not to be asked
  // roughness in (0, 1]; `passed`: what the layers let pass, at the cosines of the rule; `cos_o`: of wo.
  RoughDiffuse(float roughness, const hemisphere_rule::Values& passed, float cos_o);

  // A BRDF; for white its integral over wi with the cosine and what the layers let pass of wi is the mean of that, for
  // every wo. Local frame with z along the normal; unit directions with z > 0.
  Spectrum reflectance(const Spectrum& albedo, Vec3f wo, Vec3f wi) const;

 private:
  float lost(float c) const;

  float roughness_ = 0, scale_ = 1;   // of the first lobe
  hemisphere_rule::Values passed_{};  // over pi times its mean
  float mean_kept_ = 1;               // of light by the first lobe
  float second_ = 0;                  // lobe, over lost() of wi
};

}  // namespace meristem
