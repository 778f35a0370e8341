#include "renderer/integrators/light_choice.h"

namespace meristem {

LightChoice::LightChoice(const Scene& scene) : scene_(scene), bounds_(scene.intersector->bounds()) {
  for (std::size_t i = 0; i < scene_.lights.size(); ++i) total_ += power(i);
}

float LightChoice::power(std::size_t i) const {
  const float p = scene_.lights[i]->power(bounds_);
  return std::isfinite(p) && p > 0 ? p : 0;
}

float LightChoice::probability(std::size_t i) const {
  const float even = 1 / float(scene_.lights.size());
  return total_ > 0 && std::isfinite(total_) ? 0.5f * (even + power(i) / total_) : even;
}

std::size_t LightChoice::pick(float random) const {
  const std::size_t last = scene_.lights.size() - 1;
  for (std::size_t i = 0; i < last; ++i) {
    const float p = probability(i);
    if (random < p) return i;
    random -= p;
  }
  return last;
}

}  // namespace meristem
