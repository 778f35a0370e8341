// ProxyScene: the bounds of child cells as a scene of boxes, which grows tighter while cells expand.
//
// Bounds before expansion must hold whatever a cell may become, so they are larger than the cell. Once it has been
// expanded its real bounds are known, also after eviction (KnownCells). Whenever enough of them have come in, a new
// scene is built with them; rays that are under way finish in the old one, which stays until the end. What a ray hits
// does not depend on it: of two hits at the same distance the smaller cell key wins in whatever order cells are met.
#pragma once

#include "geometry/accel/box_scene.h"
#include "geometry/accel/known_cells.h"

#include <atomic>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace meristem {

class ProxyScene {
 public:
  // `bounds` must outlive it; what is known of them is shared. Builds on the calling thread; call inside
  // run_isolated().
  ProxyScene(std::span<const Bounds3f> bounds, const BoxContents& children, std::shared_ptr<KnownChildren> known);

  const BoxScene& scene() const { return *current_.load(std::memory_order_acquire); }
  // Whether tighten() has been called for a child, here or by a predecessor.
  bool knows(std::size_t child) const { return children_->knows(child); }
  // Notes the real bounds of a child and boxes around all of it, once for each child; may build. Any thread; not while
  // holding a lock.
  void tighten(std::size_t child, const Bounds3f& real, std::span<const Bounds3f> boxes);
  // The box of a child, by what is known of it now.
  const Bounds3f& bounds(std::size_t child) const { return knows(child) ? children_->bounds(child) : bounds_[child]; }
  // Where a ray enters a child, by what is known of it now; infinity if it does not.
  float entry(std::size_t child, const RaySpan& ray) const;
  // The same of its box, in less time.
  float box_entry(std::size_t child, const RaySpan& ray) const;
  // Of all scenes it may come to hold.
  std::size_t bytes() const { return bytes_; }

 private:
  std::unique_ptr<const BoxScene> build() const;
  void pass_thresholds();  // of known children that make it worth building again

  const std::span<const Bounds3f> bounds_;
  const BoxContents contents_;
  const std::shared_ptr<KnownChildren> children_;
  std::atomic<std::size_t> known_{0};
  std::atomic<const BoxScene*> current_{nullptr};
  std::size_t bytes_ = 0;

  std::mutex build_mutex_;
  std::vector<std::unique_ptr<const BoxScene>> scenes_;  // guarded by build_mutex_, as the next
  std::size_t next_share_ = 0;
};

}  // namespace meristem
