// RaySearch: a ray that expands nothing on its way, so that it can wait until many rays need the same cell.
//
// It passes through resident cells like any ray. A cell that it enters and that is not resident is noted, together with
// the way to it from the world's objects. Noted cells that have become resident are visited, those that begin behind
// the nearest hit so far are no longer asked for, and for the others the ray waits: for several at once, whichever
// comes first. Visiting expands the cell that it was woken for alone, goes on below it and may note more. So at least
// the cells are visited that a ray meets which expands at once, and since of two hits at one distance the tie rule
// decides, one visit too many changes nothing: the hit has the same bits. The list is complete from the beginning: no
// search starts again from a distance, which would lose hits.
//
// While it waits it holds no pointer into the geometry: what it waits for has a name and a way of indices. So the
// cell's parents may be evicted, and are expanded again when the ray goes their way.
//
// Of one thread at a time.
#pragma once

#include "geometry/accel/surface.h"
#include "geometry/base/key.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace meristem {

// Cells that a ray has entered and that were not resident.
class MissingCells {
 public:
  using Way = std::span<const std::uint32_t>;  // from the world's objects: instances and children by number

  // A ray that misses more is not worth waiting: it overflows, and nothing more is noted. Before cells are expanded for
  // the first time their boxes are wide, and hundreds are usual.
  static constexpr std::size_t most_cells = 1024;
  bool overflows() const { return count_ > most_cells; }

  void note(Key name, float entry, Way way);
  // All that have been noted, the removed ones among them: for (c = 0; c < end(); c = next(c)).
  std::size_t end() const { return words_.size(); }
  std::size_t next(std::size_t cell) const { return cell + header + words_[cell + 3]; }
  float entry(std::size_t cell) const { return std::bit_cast<float>(words_[cell]); }
  bool is_removed(std::size_t cell) const { return entry(cell) == std::numeric_limits<float>::infinity(); }
  // The names of those that the ray enters first, at or before t; each once.
  using Names = std::array<Key, 6>;
  std::size_t first(float t, Names& names) const;
  Key name(std::size_t cell) const { return words_[cell + 1] | Key(words_[cell + 2]) << 32; }
  Way way(std::size_t cell) const { return Way(words_).subspan(cell + header, words_[cell + 3]); }
  void remove(std::size_t cell);

  // While the ray waits, in no more memory than they need: those that it enters at or before t.
  struct Kept {
    std::unique_ptr<std::uint32_t[]> words;
    std::uint32_t size = 0;
  };
  Kept kept(float t) const;
  void restore(const Kept& kept);

 private:
  // One after another: the bits of the entry, the name in two words, the length of the way, the way.
  static constexpr std::size_t header = 4;
  std::vector<std::uint32_t> words_;
  std::uint32_t count_ = 0;  // noted, the removed ones among them
};

class RaySearch {
 public:
  enum class End : std::uint8_t { Missed, Met, Waits };

  // The cells that the search waits for, by names that all rays share, the nearest first; how many.
  std::size_t waits_for(MissingCells::Names& names) const;
  // Which of them goes on is to expand; else it is the nearest.
  void wake(Key name) { woken_for_ = name; }
  // Beside the object itself.
  std::size_t bytes() const { return missing_.size * sizeof(std::uint32_t) + (nearest_ ? sizeof(*nearest_) : 0); }

 private:
  friend class SearchDriver;  // of the world
  MissingCells::Kept missing_;
  std::unique_ptr<SurfaceHit> nearest_;  // so far, if there is one
  Key hit_key_ = 0, woken_for_ = 0;
  bool waits_ = false;
};

}  // namespace meristem
