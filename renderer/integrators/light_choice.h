// LightChoice: which light a point asks, by power: half of the choices go by the lights' power over the scene, half to
// all alike, so that a weak lamp nearby is not forgotten beside the sky. Made once a camera path; costs a few
// nanoseconds a light. Refers to the scene, which must outlive it.
#pragma once

#include "renderer/scene/scene.h"

namespace meristem {

class LightChoice {
 public:
  explicit LightChoice(const Scene& scene);

  // The probability with which pick() returns light i.
  float probability(std::size_t i) const;
  // The light for a uniform number; the scene must have one.
  std::size_t pick(float random) const;

 private:
  float power(std::size_t i) const;

  const Scene& scene_;
  Bounds3f bounds_;
  float total_ = 0;
};

}  // namespace meristem
