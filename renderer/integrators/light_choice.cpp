#include "renderer/integrators/light_choice.h"

namespace meristem {
namespace {

std::vector<LightBounds> bounds_of(const std::vector<std::unique_ptr<Light>>& lights) {
  std::vector<LightBounds> bounds;
  for (const auto& light : lights) bounds.push_back(light->bounds().value_or(LightBounds{}));
  return bounds;
}

}  // namespace

LightChoice::LightChoice(const std::vector<std::unique_ptr<Light>>& lights)
    : shares_(lights.size(), -1.f), tree_(bounds_of(lights)) {
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (lights[i]->bounds()) continue;
    environments_.push_back(i);
    const float estimate = lights[i]->environment_power(),
                power = std::isfinite(estimate) ? std::max(estimate, 0.f) : 0;
    mean_background_ += power / (4 * pi_f);
    shares_[i] = 0;
    if (lights[i]->is_uniform()) continue;
    asked_.push_back(i);
    shares_[i] = power;
    asked_power_ += power;
  }
  const float alike = 1 / float(asked_.size());
  for (const std::size_t i : asked_) shares_[i] = asked_power_ > 0 ? 0.5f * (alike + shares_[i] / asked_power_) : alike;
}

// Irradiances: an environment of even radiance L gives a surface pi L, and its power is 4 pi L. A lamp at a distance
// gives its importance over pi if it is flat, over 4 pi if it is round; 2 pi lies between.
float LightChoice::environment_share(const Receiver& receiver) const {
  const float near = tree_.importance(receiver) / (2 * pi_f), far = asked_power_ / 4;
  if (asked_.empty()) return 0;
  if (!(near > 0)) return 1;
  return 0.5f * (0.5f + (std::isfinite(near) ? far / (near + far) : 0));
}

LightChoice::Pick LightChoice::pick(const Receiver& receiver, float random) const {
  const float far = environment_share(receiver);
  if (random >= far) {
    Pick near = tree_.pick(receiver, std::min((random - far) / (1 - far), 0x1.fffffep-1f));
    near.probability *= 1 - far;
    return near;
  }
  random /= far;
  for (std::size_t k = 0; k + 1 < asked_.size(); ++k) {
    const float share = shares_[asked_[k]];
    if (random < share) return {int(asked_[k]), share * far};
    random -= share;
  }
  return {int(asked_.back()), shares_[asked_.back()] * far};
}

float LightChoice::probability(const Receiver& receiver, std::size_t i) const {
  const float far = environment_share(receiver);
  return shares_[i] >= 0 ? shares_[i] * far : tree_.probability(receiver, i) * (1 - far);
}

}  // namespace meristem
