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
    if (is_removed(cell) || !(e <= t)) continue;
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

MissingCells::Kept MissingCells::kept(float t) const {
  const auto is_left = [&](std::size_t cell) { return entry(cell) <= t && !is_removed(cell); };
  std::size_t size = 0;
  for (std::size_t cell = 0; cell < end(); cell = next(cell)) size += is_left(cell) ? next(cell) - cell : 0;
  Kept result{std::make_unique_for_overwrite<std::uint32_t[]>(size), std::uint32_t(size)};
  std::uint32_t* to = result.words.get();
  for (std::size_t cell = 0; cell < end(); cell = next(cell))
    if (is_left(cell)) to = std::copy(words_.data() + cell, words_.data() + next(cell), to);
  return result;
}

void MissingCells::restore(const Kept& kept) {
  words_.assign(kept.words.get(), kept.words.get() + kept.size);
  count_ = 0;
  for (std::size_t cell = 0; cell < end(); cell = next(cell)) ++count_;
}

void MissingCells::remove(std::size_t cell) {
  words_[cell] = std::bit_cast<std::uint32_t>(std::numeric_limits<float>::infinity());
}

std::size_t RaySearch::waits_for(MissingCells::Names& names) const {
  MissingCells cells;
  cells.restore(missing_);
  return cells.first(nearest_ ? nearest_->t : std::numeric_limits<float>::infinity(), names);
}

}  // namespace meristem
