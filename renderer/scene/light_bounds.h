// LightBounds: where a light stands, which way it shines, and how strongly: what is needed to choose among thousands of
// lights without asking each. Conty Estevez, Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree
// Splitting", section 4; the bounds of cosines as in Pharr, Jakob, Humphreys 2023, "Physically Based Rendering",
// section 12.6.3. Plain data; pure functions.
#pragma once

#include "geometry/base/bounds.h"

namespace meristem {

// A point that asks for light. `normal` is unit, towards the side that light can come from; zero: from both sides.
struct Receiver {
  Vec3f position;
  Vec3f normal;
};

// The defaults suit a light that shines in all directions.
struct LightBounds {
  Bounds3f box;
  float power = 0;         // flux by luminance, an estimate; 0: the light is never asked
  Vec3f axis{0, 1, 0};     // unit: the normals of the light lie around it,
  float cos_normals = -1;  // at most this angle (its cosine) away
  float cos_leaving = 0;   // light leaves within this angle of a normal
  bool two_sided = false;  // and of the opposite normals

  // An estimate of the light that arrives, up to one factor for all lights. Zero only where none can arrive.
  float importance(const Receiver& receiver) const;
};

// Bounds of two lights as one.
LightBounds united(const LightBounds& a, const LightBounds& b);

}  // namespace meristem
