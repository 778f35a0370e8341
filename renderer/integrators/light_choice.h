// LightChoice: which light a point asks. Environments are chosen by the light they send, lights that stand somewhere by
// the LightTree. Between these two kinds, half of the choices go by what each may give to the point, half to both
// alike; among environments likewise: so that none is forgotten whose estimate is poor. Uniform environments are left
// to the bounces, which find them with less noise. Made once a render; then any thread. Refers to the lights, which
// must outlive it.
#pragma once

#include "renderer/integrators/light_tree.h"
#include "renderer/scene/interfaces.h"
#include "renderer/scene/warps.h"

#include <memory>
#include <optional>
#include <vector>

namespace meristem {

class LightChoice {
 public:
  explicit LightChoice(const std::vector<std::unique_ptr<Light>>& lights);

  using Pick = LightTree::Pick;
  // One of the lights, by a uniform number; none if no light that is asked can reach the receiver.
  Pick pick(const Receiver& receiver, float random) const;
  // The probability with which pick() returns light i for this receiver.
  float probability(const Receiver& receiver, std::size_t i) const;

  // The lights without bounds, by number.
  const std::vector<std::size_t>& environments() const { return environments_; }
  const LightTree& tree() const { return tree_; }
  // The luminance of all of them together, as a mean over all directions.
  float mean_background() const { return mean_background_; }
  // Whether any light is ever picked.
  bool asks() const { return !asked_.empty() || !tree_.empty(); }

 private:
  float environment_share(const Receiver& receiver) const;

  std::vector<std::size_t> environments_, asked_;  // all of them, and those that are not uniform
  std::vector<float> shares_;  // by light: the probability among the environments; negative: not one of them
  float asked_power_ = 0, mean_background_ = 0;
  LightTree tree_;
};

}  // namespace meristem
