// CameraPaths: where the samples of a pixel begin. Immutable; any thread.
#pragma once

#include "renderer/film/film.h"
#include "renderer/film/filter_sampler.h"
#include "renderer/scene/scene.h"

namespace meristem {

// One sample of a pixel in image coordinates, by its number in the whole render.
struct PixelSample {
  int x = 0, y = 0;
  std::uint32_t number = 0;
};

// What Film wants to know of a path besides its light.
struct PathWants {
  bool first_surface = false, costs = false;
};

class CameraPaths {
 public:
  explicit CameraPaths(const Scene& scene);

  struct Start {
    Ray ray;
    int weight;  // of the sample: +1 or -1
  };
  // Leaves the sampler where the path goes on.
  Start start(const PixelSample& sample, Sampler& sampler) const;
  // What the film wants to know of a sample's first surface besides: its depth along the view axis and its motion.
  void measure(FilmSample& sample) const;
  float mean_weight() const { return filter_.mean_weight(); }

 private:
  const Scene& scene_;
  const FilterSampler filter_;
  const Ray view_axis_;  // when the shutter opens
  const bool has_lens_;
};

}  // namespace meristem
