// The directional albedo of rough glass: what its microfacets reflect and refract together by single scattering. What
// conserves energy divides by it (bsdf.h).
//
// From a table, within 0.001 of the integral for cosines from 0.05 (87 degrees) and indices from 1.05 on; 0.002 to 89
// degrees. The rows of a roughness and an index are made when they are first asked for, in some 5 ms each. Any thread.
#pragma once

namespace meristem::ggx {

// For light at the cosine `c` in [0, 1] that arrives at glass of the relative index eta, in [1/4, 1/1.01] from inside
// or [1.01, 4] from outside. alpha is that of ggx.h.
float glass_albedo(float c, float alpha, float eta);

}  // namespace meristem::ggx
