#include "geometry/accel/proxy_scene.h"

#include "geometry/base/parallel.h"

#include <algorithm>
#include <array>
#include <exception>

namespace meristem {

namespace {

// Shares of the children whose real bounds make a new scene worth its building.
constexpr std::array<double, 3> build_shares = {0.125, 0.5, 1.0};

float rounding_margin(const Bounds3f& b) { return 1e-3f * b.diagonal(); }

}  // namespace

Bounds3f with_rounding_margin(const Bounds3f& b) { return b.inflated(Vec3f(rounding_margin(b))); }

ProxyScene::ProxyScene(std::span<const Bounds3f> bounds, const BoxContents& children)
    : bounds_(bounds), contents_(children), children_(bounds.size()) {
  scenes_.push_back(build());
  current_.store(scenes_.back().get(), std::memory_order_release);
  bytes_ = scenes_.back()->bytes() * (1 + build_shares.size()) + children_.size() * (sizeof(Child) + sizeof(Outline)) +
           sizeof(*this);
}

std::unique_ptr<const BoxScene> ProxyScene::build() const {
  std::vector<Bounds3f> boxes(bounds_.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i] = bounds(i);
  return std::make_unique<const BoxScene>(boxes, contents_);
}

float ProxyScene::entry(std::size_t index, const RaySpan& ray) const {
  const Child& child = children_[index];
  if (!knows(index)) return earliest_entry(with_rounding_margin(bounds_[index]), ray);
  const float entry = earliest_entry(child.real, ray);
  return child.outline && entry <= ray.t_max ? child.outline->entry(ray) : entry;
}

std::size_t ProxyScene::threshold() const {
  const std::size_t built = scenes_.size() - 1;
  if (built >= build_shares.size()) return children_.size() + 1;
  return std::max<std::size_t>(1, std::size_t(build_shares[built] * double(children_.size())));
}

void ProxyScene::tighten(std::size_t index, const Bounds3f& real, std::span<const Bounds3f> boxes) {
  Child& child = children_[index];
  child.real = with_rounding_margin(real);
  if (boxes.size() > 1) child.outline = std::make_unique<const Outline>(real, boxes, rounding_margin(real));
  child.is_known.store(true, std::memory_order_release);
  const std::size_t known = known_.fetch_add(1) + 1;
  const std::unique_lock lock(build_mutex_, std::try_to_lock);
  if (!lock || known < threshold()) return;
  try {
    run_isolated([&] { scenes_.push_back(build()); });
    current_.store(scenes_.back().get(), std::memory_order_release);
  } catch (const std::exception&) {
    scenes_.push_back(nullptr);  // no memory for a better scene: the old one serves
  }
}

}  // namespace meristem
