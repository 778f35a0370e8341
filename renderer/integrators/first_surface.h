// What an integrator reports of the first surface that a camera ray shows (FirstSurface). Nothing is done if nobody
// asks.
#pragma once

#include "renderer/materials/bsdf.h"
#include "renderer/scene/scene.h"

namespace meristem {

// A surface whose material has been evaluated.
inline void report_first(FirstSurface* first, const SurfaceHit& hit, const Bsdf& bsdf) {
  if (!first) return;
  first->hit = hit;
  first->albedo = bsdf.albedo();
  first->material = std::max(hit.origin.material, 0);
  if (hit.origin.production != no_production) first->production = hit.origin.production;
}

// One whose material the integrator does not need.
inline void report_first(FirstSurface* first, const Scene& scene, const Ray& ray, const SurfaceHit& hit) {
  if (!first) return;
  report_first(first, hit, scene.material_of(hit).evaluate({hit, -ray.direction}));
}

}  // namespace meristem
