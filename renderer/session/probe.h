// What one sample of a pixel asks of the world, ray by ray: what each met, how many cells had to be expanded for it and
// how long it took.
#pragma once

#include "renderer/film/film.h"
#include "renderer/session/camera_paths.h"

#include <optional>
#include <vector>

namespace meristem {

struct ProbedRay {
  Ray ray;
  bool is_light = false;  // towards a light that is asked; else the one that goes on
  bool any = false;       // of which it is only asked whether it meets something
  bool met = false;
  SurfaceHit hit = {};  // the nearest, unless `any`
  ThreadExpansions expansions = {};
  double seconds = 0;
};

struct ProbedSample {
  FirstSurface first;
  float depth = 0;  // of the first surface
  Spectrum radiance;
  std::vector<ProbedRay> rays;  // in the order in which they were traced
};

// Follows the samples 0, 1, ... of a pixel as a render does, one after another, in one thread: what one has expanded
// the next finds. The radiance has the bits of a render. Of an integrator whose paths cannot be stopped only the camera
// ray is told.
std::vector<ProbedSample> probe_pixel(const Scene& scene, int x, int y, int samples);

}  // namespace meristem
