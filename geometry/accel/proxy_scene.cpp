#include "geometry/accel/proxy_scene.h"

#include "geometry/base/parallel.h"

#include <algorithm>
#include <array>
#include <exception>

namespace meristem {

namespace {

// Shares of the children whose real bounds make a new scene worth its building. Some children may never be met, so the
// last scene but one must leave few boxes as wide as they were.
constexpr std::array build_shares = {0.125, 0.5, 0.875, 0.96875, 1.0};

}  // namespace

ProxyScene::ProxyScene(std::span<const Bounds3f> bounds, const BoxContents& children,
                       std::shared_ptr<KnownChildren> known)
    : bounds_(bounds), contents_(children), children_(std::move(known)) {
  for (std::size_t i = 0; i < bounds.size(); ++i) known_ += knows(i);
  pass_thresholds();
  scenes_.push_back(build());
  current_.store(scenes_.back().get(), std::memory_order_release);
  bytes_ = scenes_.back()->bytes() * (1 + build_shares.size()) + KnownChildren::bytes(bounds.size()) + sizeof(*this);
}

std::unique_ptr<const BoxScene> ProxyScene::build() const {
  std::vector<Bounds3f> boxes(bounds_.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i] = bounds(i);
  return std::make_unique<const BoxScene>(boxes, contents_);
}

float ProxyScene::entry(std::size_t index, const RaySpan& ray) const {
  return knows(index) ? children_->entry(index, ray) : box_entry(index, ray);
}

float ProxyScene::box_entry(std::size_t index, const RaySpan& ray) const {
  return earliest_entry(knows(index) ? children_->bounds(index) : with_rounding_margin(bounds_[index]), ray);
}

void ProxyScene::pass_thresholds() {
  const auto threshold = [&] {
    return std::max<std::size_t>(1, std::size_t(build_shares[next_share_] * double(bounds_.size())));
  };
  while (next_share_ < build_shares.size() && known_ >= threshold()) ++next_share_;
}

void ProxyScene::tighten(std::size_t index, const Bounds3f& real, std::span<const Bounds3f> boxes) {
  children_->note(index, real, boxes);
  known_.fetch_add(1);
  const std::unique_lock lock(build_mutex_, std::try_to_lock);
  if (!lock) return;
  const std::size_t share = next_share_;
  pass_thresholds();
  if (next_share_ == share) return;
  try {
    run_isolated([&] { scenes_.push_back(build()); });
    current_.store(scenes_.back().get(), std::memory_order_release);
  } catch (const std::exception&) {  // no memory for a better scene: the old one serves
  }
}

}  // namespace meristem
