// The fuzz lobe: cloth, dust, peach skin. A layer of fibres that shines where it is seen at a grazing angle.
//
// Distribution: Estevez and Kulla 2017, "Production Friendly Microfacet Sheen BRDF", equation 2 (in place of the LTC
// fit of Zeltner, Burley, Chiang 2022 that OpenPBR names); visibility: Neubelt and Pettineo 2013. Local frame with z
// along the normal; directions unit with z > 0. Pure functions, any thread; the rows of the table of albedos are made
// where they are first needed.
#pragma once

#include "geometry/base/vec.h"

namespace meristem::fuzz {

constexpr float min_roughness = 0.05f;

// The BRDF of white fibres; roughness in [min_roughness, 1].
float reflectance(Vec3f wo, Vec3f wi, float roughness);
// Its directional albedo at cosine `c`; at most 1.
float albedo(float c, float roughness);

}  // namespace meristem::fuzz
