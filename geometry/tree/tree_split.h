// Ranges of items, and how they are split.
#pragma once

#include "geometry/tree/tree_items.h"

#include <array>
#include <span>
#include <utility>

namespace meristem::tree {

struct Extent {
  Box box, centroids;  // of items; centroids doubled
  std::size_t weight = 0;

  void add(const Item& item) {
    box.extend(item.box);
    centroids.extend(item.doubled_centroid());
    weight += item.weight();
  }
  void add(const Extent& e) {
    box.extend(e.box);
    centroids.extend(e.centroids);
    weight += e.weight;
  }
};

struct Range {
  std::span<Item> items;
  Extent extent;
};

inline Extent extent_of(std::span<const Item> items) {
  Extent extent;
  for (const Item& item : items) extent.add(item);
  return extent;
}

// Where items lie along the axis along which their centroids lie farthest apart.
class Axis {
 public:
  explicit Axis(const Box& centroids) {
    alignas(16) float lower[4], size[4];
    _mm_store_ps(lower, centroids.lower);
    _mm_store_ps(size, _mm_sub_ps(centroids.upper, centroids.lower));
    axis_ = size[0] >= size[1] ? (size[0] >= size[2] ? 0 : 2) : (size[1] >= size[2] ? 1 : 2);
    lower_ = lower[axis_];
    size_ = size[axis_];
  }
  bool is_point() const { return !(size_ > 1e-30f) || !std::isfinite(size_); }  // or too small to be divided
  float place(const Item& item) const {
    alignas(16) float c[4];
    _mm_store_ps(c, item.doubled_centroid());
    return c[axis_];
  }
  std::size_t bin(const Item& item, std::size_t bins) const {
    return std::min(std::size_t((place(item) - lower_) * (float(bins) / size_)), bins - 1);
  }

 private:
  int axis_;
  float lower_, size_;
};

// The items before `middle`, and the others.
std::pair<Range, Range> cut_at(std::span<Item> items, std::size_t middle);

// Two parts, each with an item at least: by the surface area heuristic over bins along the widest axis (Wald 2007, "On
// fast Construction of SAH-based Bounding Volume Hierarchies"). Sorts the items.
std::pair<Range, Range> split(const Range& range, int level);

// The children of a node: parts of the range, of which the largest that weighs more than `enough` is split until there
// are eight, or none. Returns how many.
std::size_t split_for_node(const Range& range, int level, std::size_t enough,
                           std::array<Range, most_children>& children);

}  // namespace meristem::tree
