// Medium: what absorbs, scatters and emits light between surfaces, inside a box. Media may overlap: their densities
// add.
#pragma once

#include "renderer/scene/interfaces.h"
#include "renderer/scene/random_stream.h"

namespace meristem {

// Where light meets the matter of a medium.
struct MediumCollision {
  float t = 0;           // along the ray
  Spectrum albedo;       // the part of the light that is scattered
  Spectrum emission;     // radiance that the matter sends here, in place of what lies behind
  float anisotropy = 0;  // of Henyey and Greenstein's phase function (renderer/media/phase.h)
};

class Medium {
 public:
  virtual ~Medium() = default;
  // Whether light along the ray collides before ray.t_max, with the probability that it has of doing so.
  virtual bool collide(const Ray& ray, RandomStream& random, MediumCollision& collision) const = 0;
  // An unbiased estimate of the part of the light that passes from the origin to ray.t_max; in [0, 1] in the mean.
  virtual float transmittance(const Ray& ray, RandomStream& random) const = 0;
};

}  // namespace meristem
