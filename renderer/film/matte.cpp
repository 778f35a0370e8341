#include "renderer/film/matte.h"

#include <algorithm>

namespace meristem {

void Matte::add(std::size_t pixel, MatteEntry entry) {
  std::vector<MatteEntry>& list = pixels_[pixel];
  const auto at = std::ranges::lower_bound(list, entry.thing, {}, &MatteEntry::thing);
  if (at != list.end() && at->thing == entry.thing)
    at->weight += entry.weight;
  else
    list.insert(at, entry);
}

void Matte::merge(const Matte& other) {
  for (std::size_t i = 0; i < pixels_.size(); ++i)
    for (const MatteEntry& entry : other.pixels_[i]) add(i, entry);
}

}  // namespace meristem
