// The colour of a black body at a temperature, scene-linear Rec.709, of luminance 1.
#pragma once

#include "geometry/base/vec.h"

namespace meristem {

// Planck's law weighed by the CIE 1931 observer as Wyman, Sloan, Shirley 2013 fit it ("Simple Analytic Approximations
// to the CIE XYZ Color Matching Functions"). Colours outside of Rec.709 are clamped to it.
Vec3d blackbody_color(double kelvin);

}  // namespace meristem
