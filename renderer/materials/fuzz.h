// The fuzz lobe: cloth, dust, peach skin. A layer of fibres that shines where it is seen at a grazing angle.
//
// Distribution: Estevez and Kulla 2017, "Production Friendly Microfacet Sheen BRDF", equation 2 (in place of the LTC
// fit of Zeltner, Burley, Chiang 2022 that OpenPBR names); visibility: Neubelt and Pettineo 2013. Local frame with z
// along the normal; directions unit with z > 0. Pure functions, any thread; the rows of the table of albedos are made
// where they are first needed.
#pragma once

#include "geometry/base/vec.h"
#include "renderer/materials/hemisphere_rule.h"

namespace meristem::fuzz {

constexpr float min_roughness = 0.05f;

struct FiberRow;

// White fibres of one roughness. A small value that refers to rows of the table, which are never freed.
class Fibers {
 public:
  Fibers() = default;                // of nothing: not to be asked
  explicit Fibers(float roughness);  // in [min_roughness, 1]

  // The BRDF.
  float reflectance(Vec3f wo, Vec3f wi) const;
  // Its directional albedo at cosine `c`: at most 1.
  float albedo(float c) const;
  hemisphere_rule::Values albedo_at_rule() const;

 private:
  const FiberRow *smoother_ = nullptr, *rougher_ = nullptr;  // the rows beside the roughness,
  float by_roughness_ = 0;                                   // and how far between them
  float exponent_ = 2, scale_ = 1;
};

}  // namespace meristem::fuzz
