#include "geometry/tree/tree_split.h"

#include "geometry/tree/surface_tree.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace meristem::tree {

namespace {

constexpr std::size_t bins = 8;

}  // namespace

std::pair<Range, Range> cut_at(std::span<Item> items, std::size_t middle) {
  const auto a = items.first(middle), b = items.subspan(middle);
  return {{a, extent_of(a)}, {b, extent_of(b)}};
}

std::pair<Range, Range> split(const Range& range, int level) {
  constexpr int most_uneven_levels = SurfaceTree::most_levels / 2;
  const Axis axis(range.extent.centroids);
  const std::size_t half = range.items.size() / 2;
  if (axis.is_point() || level > most_uneven_levels) return cut_at(range.items, half);
  std::array<Extent, bins> extents;
  for (const Item& item : range.items) extents[axis.bin(item, bins)].add(item);
  const auto cost = [](const Extent& e) { return e.weight > 0 ? e.box.area() * float(e.weight) : INFINITY; };
  std::array<float, bins> cost_behind{};
  Extent behind, before;
  for (std::size_t i = bins - 1; i > 0; --i) {
    behind.add(extents[i]);
    cost_behind[i] = cost(behind);
  }
  float least = INFINITY;
  std::size_t best = 0;
  for (std::size_t i = 1; i < bins; ++i) {
    before.add(extents[i - 1]);
    if (const float both = cost(before) + cost_behind[i]; both < least) least = both, best = i;
  }
  if (best == 0) return cut_at(range.items, half);
  const auto second =
      std::ranges::partition(range.items, [&](const Item& item) { return axis.bin(item, bins) < best; });
  const auto first_count = range.items.size() - second.size();
  std::pair<Range, Range> parts{{range.items.first(first_count), {}}, {range.items.subspan(first_count), {}}};
  for (std::size_t i = 0; i < bins; ++i) (i < best ? parts.first : parts.second).extent.add(extents[i]);
  return parts;
}

std::size_t split_for_node(const Range& range, int level, std::size_t enough,
                           std::array<Range, most_children>& children) {
  std::size_t count = 1;
  children[0] = range;
  while (count < most_children) {
    Range* largest = nullptr;
    for (std::size_t i = 0; i < count; ++i)
      if (children[i].extent.weight > enough &&
          (!largest || children[i].extent.box.area() > largest->extent.box.area()))
        largest = &children[i];
    if (!largest) break;
    std::tie(*largest, children[count++]) = split(*largest, level);
  }
  return count;
}

}  // namespace meristem::tree
