#include "geometry/accel/known_cells.h"

namespace meristem {

namespace {

float rounding_margin(const Bounds3f& b) { return 1e-3f * b.diagonal(); }

}  // namespace

Bounds3f with_rounding_margin(const Bounds3f& b) { return b.inflated(Vec3f(rounding_margin(b))); }

void KnownChildren::note(std::size_t index, const Bounds3f& real, std::span<const Bounds3f> boxes) {
  const std::lock_guard lock(mutex_);
  if (knows(index)) return;
  Child& child = children_[index];
  child.real = with_rounding_margin(real);
  if (boxes.size() > 1) child.outline = std::make_unique<const Outline>(real, boxes, rounding_margin(real));
  child.is_known.store(true, std::memory_order_release);
}

float KnownChildren::entry(std::size_t index, const RaySpan& ray) const {
  const Child& child = children_[index];
  const float entry = earliest_entry(child.real, ray);
  return child.outline && entry <= ray.t_max ? child.outline->entry(ray) : entry;
}

std::size_t KnownCells::bytes_of(std::size_t children) {
  constexpr std::size_t node_bytes = 128;  // of the map and the list
  return KnownChildren::bytes(children) + node_bytes;
}

std::shared_ptr<KnownChildren> KnownCells::of(Key cell, std::size_t children) {
  const std::size_t bytes = bytes_of(children);
  if (bytes > most_bytes_) return std::make_shared<KnownChildren>(children);
  const std::lock_guard lock(mutex_);
  if (const auto kept = cells_.find(cell); kept != cells_.end()) {
    ages_.splice(ages_.end(), ages_, kept->second.age);
    return kept->second.children;
  }
  while (bytes_ + bytes > most_bytes_) forget_oldest();
  auto made = std::make_shared<KnownChildren>(children);
  cells_[cell] = {made, ages_.insert(ages_.end(), cell)};
  bytes_ += bytes;
  return made;
}

void KnownCells::forget_oldest() {
  const auto oldest = cells_.find(ages_.front());
  bytes_ -= bytes_of(oldest->second.children->size());
  cells_.erase(oldest);
  ages_.pop_front();
}

}  // namespace meristem
