#include "geometry/accel/ray_search.h"

#include <bit>
#include <limits>

namespace meristem {

void MissingCells::note(Key name, float entry, Way way) {
  if (++count_ > most_cells) return;
  words_.insert(words_.end(), {std::bit_cast<std::uint32_t>(entry), std::uint32_t(name), std::uint32_t(name >> 32),
                               std::uint32_t(way.size())});
  words_.insert(words_.end(), way.begin(), way.end());
}

std::size_t MissingCells::first(float t) const {
  std::size_t result = none;
  for (std::size_t cell = 0; cell < words_.size(); cell += header + words_[cell + 3]) {
    const auto entry = std::bit_cast<float>(words_[cell]);
    if (entry < std::numeric_limits<float>::infinity() && entry <= t) result = cell, t = entry;
  }
  return result;
}

void MissingCells::remove(std::size_t cell) {
  words_[cell] = std::bit_cast<std::uint32_t>(std::numeric_limits<float>::infinity());
}

}  // namespace meristem
