// What is known of the children of cells that were split, by the cells: it outlasts them in the cache. Else a cell that
// was evicted and is needed again would know nothing of its children, and rays would expand all that they enter.
#pragma once

#include "geometry/accel/outline.h"
#include "geometry/base/key.h"

#include <atomic>
#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

namespace meristem {

// Rounding lets a ray meet a triangle a little beyond its edges. Were that cut off by bounds, what a ray hits would
// depend on when they came.
Bounds3f with_rounding_margin(const Bounds3f& real);

// Of one cell. Any thread.
class KnownChildren {
 public:
  explicit KnownChildren(std::size_t count) : children_(count) {}

  std::size_t size() const { return children_.size(); }
  bool knows(std::size_t child) const { return children_[child].is_known.load(std::memory_order_acquire); }
  // The bounds of a child and boxes around all of it; once, what comes later is the same.
  void note(std::size_t child, const Bounds3f& real, std::span<const Bounds3f> boxes);
  // Of one that it knows: its box,
  const Bounds3f& bounds(std::size_t child) const { return children_[child].real; }
  // and where a ray enters it; infinity if it does not.
  float entry(std::size_t child, const RaySpan& ray) const;

  // Of so many children, all known.
  static std::size_t bytes(std::size_t count) {
    return sizeof(KnownChildren) + count * (sizeof(Child) + sizeof(Outline));
  }

 private:
  struct Child {
    Bounds3f real;                           // written before is_known
    std::unique_ptr<const Outline> outline;  // as well
    std::atomic<bool> is_known{false};
  };
  std::vector<Child> children_;
  std::mutex mutex_;  // of those who write
};

class KnownCells {
 public:
  // It keeps so much at most; which cells were asked for longest ago is forgotten.
  explicit KnownCells(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  // What is known of a cell with so many children. Any thread.
  std::shared_ptr<KnownChildren> of(Key cell, std::size_t children);
  // Cells of different roots are not the same, whatever their keys.
  Key new_root() { return ++roots_; }
  std::size_t bytes() const { return bytes_.load(std::memory_order_relaxed); }

 private:
  struct Kept {
    std::shared_ptr<KnownChildren> children;
    std::list<Key>::iterator age;
  };
  static std::size_t bytes_of(std::size_t children);
  void forget_oldest();

  const std::size_t most_bytes_;
  std::atomic<Key> roots_{0};
  std::atomic<std::size_t> bytes_{0};
  std::mutex mutex_;  // guards what follows
  std::unordered_map<Key, Kept> cells_;
  std::list<Key> ages_;  // the oldest first
};

}  // namespace meristem
