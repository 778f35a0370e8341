#include "geometry/accel/ray_search.h"

#include <algorithm>

namespace meristem {

void CellList::append(std::vector<std::uint32_t>& words, const Cell& cell, Way way) {
  words.insert(words.end(), {std::bit_cast<std::uint32_t>(cell.entry),
                             std::uint32_t(cell.name) << flag_bits | (cell.is_known ? known_bit : 0) |
                                 (cell.is_exact ? exact_bit : 0) | std::uint32_t(way.size())});
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
  if (size != words().size()) {
    words_ = std::make_unique_for_overwrite<std::uint32_t[]>(1 + size);
    words_[0] = std::uint32_t(size);
  }
  std::uint32_t* to = words_.get() + 1;
  for (std::size_t cell = 0; cell < list.end(); cell = list.next(cell))
    if (is_left(cell)) to = std::ranges::copy(list.words(cell), to).out;
}

void MissingCells::note(const CellList::Cell& cell, CellList::Way way) {
  if (way.size() > CellList::longest_way) count_ = most_cells;
  if (++count_ > most_cells) return;
  if (cell.is_known && cell.is_exact) nearest_exact_ = std::min(nearest_exact_, cell.entry);
  CellList::append(words_, cell, way);
}

void MissingCells::restore(const KeptCells& kept) {
  const CellList::Words words = kept.words();
  words_.assign(words.begin(), words.end());
  count_ = 0;
  nearest_exact_ = CellList::removed;
  for (std::size_t cell = 0; cell < words.size(); cell = list().next(cell)) ++count_;
}

void RaySearch::wake(Key name) {
  const CellList list(missing_.words());
  std::size_t cell = 0;
  while (cell < list.end() && list.name(cell) != name) cell = list.next(cell);
  sleeps_ = waits() && cell == list.end();
  if (!sleeps_) woken_for_ = std::uint32_t(name);
}

void MissingCells::remove(std::size_t cell) { words_[cell] = std::bit_cast<std::uint32_t>(CellList::removed); }

}  // namespace meristem
