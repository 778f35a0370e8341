// RaySearch: a ray that expands nothing on its way, so that it can wait until many rays need the same cell.
//
// It passes through resident cells like any ray. A cell that it enters and that is not resident is noted, together with
// the way to it from the world's objects. Noted cells that have become resident are visited, those that begin behind
// the nearest hit so far are no longer asked for, and of the others the ray waits for the one that it enters first. A
// cell that was never expanded before does not wait: the ray expands it as soon as it is the nearest of those noted.
// Visiting expands the cell that it was woken for alone, goes on below it and may note more. So at least the cells are
// visited that a ray meets which expands at once, and since of two hits at one distance the tie rule decides, one visit
// too many changes nothing: the hit has the same bits. The list is complete from the beginning: no search starts again
// from a distance, which would lose hits.
//
// While it waits it holds no pointer into the geometry: what it waits for has a name and a way of indices. So the
// cell's parents may be evicted, and are expanded again when the ray goes their way.
//
// Of one thread at a time.
#pragma once

#include "geometry/accel/surface.h"
#include "geometry/base/key.h"

#include <bit>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace meristem {

// Cells that a ray has entered and that were not resident: a list in words that others hold.
class CellList {
 public:
  using Words = std::span<const std::uint32_t>;
  using Way = Words;  // from the world's objects: instances and children by number

  explicit CellList(Words words) : words_(words) {}
  // All, the removed ones among them: for (c = 0; c < end(); c = next(c)).
  std::size_t end() const { return words_.size(); }
  std::size_t next(std::size_t cell) const { return cell + header + way_length(cell); }
  float entry(std::size_t cell) const { return std::bit_cast<float>(words_[cell]); }
  bool is_removed(std::size_t cell) const { return entry(cell) == removed; }
  // Whether it had been expanded before it was noted,
  bool is_known(std::size_t cell) const { return words_[cell + 1] & known_bit; }
  // and whether its entry is that into its outline, and not only into its box.
  bool is_exact(std::size_t cell) const { return words_[cell + 1] & exact_bit; }
  // The last bits of it. Cells that share them are waited for and expanded together: that costs time, and no more.
  std::uint32_t name(std::size_t cell) const { return words_[cell + 1] >> flag_bits; }
  Way way(std::size_t cell) const { return words_.subspan(cell + header, way_length(cell)); }

  // All of one.
  Words words(std::size_t cell) const { return words_.subspan(cell, next(cell) - cell); }

  // The one that the ray enters first, at or before t; end() if there is none.
  std::size_t nearest(float t) const;

  struct Cell {
    Key name;
    float entry;
    bool is_known, is_exact;
  };
  static void append(std::vector<std::uint32_t>& words, const Cell& cell, Way way);
  static constexpr std::size_t longest_way = 63;
  static constexpr float removed = std::numeric_limits<float>::infinity();  // as an entry

 private:
  // One after another: the bits of the entry; the name, whether it is known and exact and the length of the way; the
  // way.
  static constexpr std::size_t header = 2;
  static constexpr int flag_bits = 8;
  static constexpr std::uint32_t known_bit = 64, exact_bit = 128;
  std::size_t way_length(std::size_t cell) const { return words_[cell + 1] & longest_way; }

  Words words_;
};

// Such a list while its ray waits, in no more memory than it needs.
class KeptCells {
 public:
  // Those of a list that the ray enters at or before t.
  void assign(const CellList& list, float t);
  CellList::Words words() const { return words_ ? CellList::Words(&words_[1], words_[0]) : CellList::Words(); }
  bool empty() const { return !words_ || words_[0] == 0; }
  void prefetch() const { __builtin_prefetch(words_.get()); }
  std::size_t bytes_beside() const { return words_ ? (1 + words_[0]) * sizeof(std::uint32_t) + malloc_bytes : 0; }
  static constexpr std::size_t malloc_bytes = 16;  // that an allocation takes beside

 private:
  std::unique_ptr<std::uint32_t[]> words_;  // after their number
};

// Such a list while it grows.
class MissingCells {
 public:
  // A ray that misses more is not worth waiting: it overflows, and nothing more is noted.
  static constexpr std::size_t most_cells = 1024;
  bool overflows() const { return count_ > most_cells; }

  void note(const CellList::Cell& cell, CellList::Way way);
  // Whether a cell that is entered there might be the nearest of those that were noted with exact entries.
  bool may_be_nearest(float entry) const { return entry < nearest_exact_; }
  CellList list() const { return CellList(words_); }  // until the next is noted
  void remove(std::size_t cell);
  void restore(const KeptCells& kept);

 private:
  std::vector<std::uint32_t> words_;
  std::uint32_t count_ = 0;  // noted, the removed ones among them
  float nearest_exact_ = CellList::removed;
};

// Of two hits at one distance that with the smaller rank counts. What decides belongs to the geometry: the instances
// around it, then where the triangle lies. The cell's key is asked only where a triangle stands there twice.
struct HitRank {
  Key path, triangle, cell;
  auto operator<=>(const HitRank&) const = default;
};

class RaySearch {
 public:
  enum class End : std::uint8_t { Missed, Met, Waits };

  // The cell that the search waits for, by a name that all rays share, if it waits.
  std::optional<Key> waits_for() const { return waits() ? std::optional<Key>(woken_for_) : std::nullopt; }
  // Which of its cells it is to expand when it goes on; else it is the one that it waits for. If that is none of its
  // cells it sleeps on.
  void wake(Key name);
  bool sleeps() const { return sleeps_; }
  // What it will need to go on, into the processor's caches.
  void prefetch() const {
    missing_.prefetch();
    __builtin_prefetch(nearest_.get());
  }
  // Beside the object itself.
  std::size_t bytes() const {
    return missing_.bytes_beside() + (nearest_ ? sizeof(*nearest_) + KeptCells::malloc_bytes : 0);
  }

 private:
  friend class SearchDriver;  // of the world
  struct Nearest {
    SurfaceHit hit;
    HitRank rank;
  };
  bool waits() const { return !missing_.empty(); }

  KeptCells missing_;
  std::unique_ptr<Nearest> nearest_;  // so far, if there is one
  std::uint32_t woken_for_ = 0;       // as CellList::name() gives it
  bool sleeps_ = false;
};
static_assert(sizeof(RaySearch) <= 24, "millions wait at once");

}  // namespace meristem
