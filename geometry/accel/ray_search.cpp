#include "geometry/accel/ray_search.h"

#include <algorithm>

namespace meristem {

void CellList::append(std::vector<std::uint32_t>& words, Key name, float entry, bool is_known, Way way) {
  words.insert(words.end(), {std::bit_cast<std::uint32_t>(entry), std::uint32_t(name), std::uint32_t(name >> 32),
                             std::uint32_t(way.size()) | (is_known ? known_bit : 0)});
  words.insert(words.end(), way.begin(), way.end());
}

std::size_t CellList::nearest(float t) const {
  std::size_t nearest = end();
  for (std::size_t cell = 0; cell < end(); cell = next(cell))
    if (!is_removed(cell) && entry(cell) <= t && (nearest == end() || entry(cell) < entry(nearest))) nearest = cell;
  return nearest;
}

void KeptCells::assign(const CellList& list, float t) {
  const auto is_left = [&](std::size_t cell) { return list.entry(cell) <= t && !list.is_removed(cell); };
  std::size_t size = 0;
  for (std::size_t cell = 0; cell < list.end(); cell = list.next(cell))
    size += is_left(cell) ? list.next(cell) - cell : 0;
  size_ = std::uint32_t(size);
  more_ = size > few_.size() ? std::make_unique_for_overwrite<std::uint32_t[]>(size) : nullptr;
  std::uint32_t* to = more_ ? more_.get() : few_.data();
  for (std::size_t cell = 0; cell < list.end(); cell = list.next(cell))
    if (is_left(cell)) to = std::ranges::copy(list.words(cell), to).out;
}

void MissingCells::note(Key name, float entry, bool is_known, CellList::Way way) {
  if (++count_ > most_cells) return;
  CellList::append(words_, name, entry, is_known, way);
}

void MissingCells::restore(const KeptCells& kept) {
  const CellList::Words words = kept.words();
  words_.assign(words.begin(), words.end());
  count_ = 0;
  for (std::size_t cell = 0; cell < words.size(); cell = list().next(cell)) ++count_;
}

void MissingCells::remove(std::size_t cell) { words_[cell] = std::bit_cast<std::uint32_t>(CellList::removed); }

}  // namespace meristem
