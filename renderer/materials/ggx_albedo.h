// Directional albedos of GGX microfacets: which part of the light from a direction single scattering gives back, and
// its cosine-weighted mean over all directions. What conserves energy divides by them (bsdf.h).
//
// `c` is the cosine of the direction in [0, 1], alpha and f0 are those of ggx.h. From tables, within 0.001 of the
// integral; the rows of a roughness are made when it is first asked for, in some 2 ms. Any thread.
#pragma once

namespace meristem::ggx {

float dielectric_albedo(float c, float alpha, float f0);
float dielectric_mean_albedo(float alpha, float f0);
// The same with a Fresnel term of 1: what is missing from 1 is lost to scattering between microfacets.
float white_albedo(float c, float alpha);
float white_mean_albedo(float alpha);
// What a microfacet surface of glass with index eta in [1, 4] reflects and refracts together, for light that arrives
// from outside, or from `inside` the glass. From a table of its own.
float glass_albedo(float c, float alpha, float eta, bool inside);

}  // namespace meristem::ggx
