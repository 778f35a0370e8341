#include "geometry/accel/ray_search.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace meristem {

void MissingCells::note(Key name, float entry, Way way) {
  if (++count_ > most_cells) return;
  words_.insert(words_.end(), {std::bit_cast<std::uint32_t>(entry), std::uint32_t(name), std::uint32_t(name >> 32),
                               std::uint32_t(way.size())});
  words_.insert(words_.end(), way.begin(), way.end());
}

std::size_t MissingCells::first(float t, Names& names) const {
  std::array<float, std::tuple_size_v<Names>> entries;
  std::size_t count = 0;
  for (std::size_t cell = 0; cell < end(); cell = next(cell)) {
    const float e = entry(cell);
    if (e == std::numeric_limits<float>::infinity() || !(e <= t)) continue;
    const Key n = name(cell);
    std::size_t at = count;
    if (const auto same = std::find(names.begin(), names.begin() + std::ptrdiff_t(count), n) - names.begin();
        same < std::ptrdiff_t(count)) {
      if (entries[std::size_t(same)] <= e) continue;
      at = std::size_t(same);
    } else if (count < names.size()) {
      ++count;
    } else if (--at; entries[at] <= e) {
      continue;
    }
    for (; at > 0 && entries[at - 1] > e; --at) names[at] = names[at - 1], entries[at] = entries[at - 1];
    names[at] = n, entries[at] = e;
  }
  return count;
}

void MissingCells::compact() {
  std::size_t kept = 0;
  count_ = 0;
  for (std::size_t cell = 0, after = 0; cell < end(); cell = after) {
    after = next(cell);
    if (entry(cell) == std::numeric_limits<float>::infinity()) continue;
    std::copy(words_.begin() + std::ptrdiff_t(cell), words_.begin() + std::ptrdiff_t(after),
              words_.begin() + std::ptrdiff_t(kept));
    kept += after - cell;
    ++count_;
  }
  words_.resize(kept);
  if (words_.capacity() > 2 * kept + 64) words_.shrink_to_fit();
}

void MissingCells::remove(std::size_t cell) {
  words_[cell] = std::bit_cast<std::uint32_t>(std::numeric_limits<float>::infinity());
}

}  // namespace meristem
