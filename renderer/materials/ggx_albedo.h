// Directional albedos of GGX microfacets: which part of the light from a direction single scattering gives back, and
// its cosine-weighted mean over all directions. What conserves energy divides by them (bsdf.h).
//
// `c` is the cosine of the direction in [0, 1], alpha and f0 are those of ggx.h. From tables, within 0.001 of the
// integral for c from 0.02 (89 degrees) on. The rows of a roughness are made when it is first asked for, in some 3 ms.
// Any thread.
#pragma once

#include "renderer/materials/hemisphere_rule.h"

namespace meristem::ggx {

struct AlbedoRow;

// Of one roughness and reflectance. A small value that refers to rows of the tables, which are never freed.
class Albedo {
 public:
  Albedo() = default;  // of nothing: not to be asked
  static Albedo dielectric(float alpha, float f0);
  // With a Fresnel term of 1: what is missing from 1 is lost to scattering between microfacets.
  static Albedo white(float alpha);

  float at(float c) const;
  float mean() const;
  hemisphere_rule::Values at_rule() const;  // at() of its cosines

 private:
  const AlbedoRow *smoother_ = nullptr, *rougher_ = nullptr;  // the rows beside the roughness,
  int layer_ = 0;                                             // and in them that layer of f0 and the next,
  float by_alpha_ = 0, by_f0_ = 0;                            // and how far between the two of each
};

}  // namespace meristem::ggx
