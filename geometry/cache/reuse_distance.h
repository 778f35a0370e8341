// ReuseDistances: from the expansions and evictions under one budget, an estimate of how many repeated expansions a
// larger budget would have had.
//
// A cell that was evicted with `resident` bytes in the cache and is expanded again later would still be there if the
// cache had held, besides those bytes, all that came in since: the distinct bytes expanded between its eviction and its
// return (Mattson et al. 1970, "Evaluation techniques for storage hierarchies", stack distances; the clock of the cache
// behaves like LRU within 0.1 points). A cell that was resident at the eviction and came back afterwards counts twice,
// so the estimate errs towards larger budgets. No budget above the bytes of all cells together evicts anything.
//
// Memory is bounded by following a sample of the cells, chosen by a hash of their names; its share is halved when the
// sample outgrows its limit (Waldspurger et al. 2015, "Efficient MRC construction with SHARDS"). Positions in the
// stream of expanded bytes are kept in 1024 buckets, so distances are as fine as a thousandth of the stream.
// One thread at a time.
#pragma once

#include "geometry/base/expansion_profile.h"
#include "geometry/base/key.h"

#include <array>
#include <unordered_map>
#include <vector>

namespace meristem {

class ReuseDistances {
 public:
  explicit ReuseDistances(std::size_t max_cells = 1 << 16) : max_cells_(max_cells) {}

  // A cell came in. True if it had been expanded before, as far as is known: of cells outside the sample nothing is.
  bool expanded(Key cell, std::size_t bytes);
  // It went, when `resident_bytes` were there, its own included.
  void evicted(Key cell, std::size_t resident_bytes);

  ReuseFigures figures() const;

 private:
  struct Cell {
    std::uint64_t expanded_at;  // position in the stream
    std::uint64_t evicted_at = 0, resident_then = 0;
    std::size_t bytes;
  };
  bool is_sampled(Key cell) const { return shift_ == 64 || scramble(cell) >> shift_ == 0; }
  double weight() const;  // of a sampled cell
  std::size_t bucket_of(std::uint64_t position);
  void add_to_bucket(std::uint64_t position, double bytes);
  double distinct_bytes_since(std::uint64_t position);
  void count_reuse(double needed_bytes);
  void thin_out();

  static constexpr std::size_t bucket_count = 1024;
  static constexpr int needs_per_octave = 16;

  const std::size_t max_cells_;
  int shift_ = 64;  // a cell is sampled if its hash has no bit from here on; 64: all are
  std::unordered_map<Key, Cell> cells_;
  std::uint64_t position_ = 0;  // bytes that came in so far, of all cells
  std::uint64_t bucket_bytes_ = 1 << 16;
  std::array<double, bucket_count> buckets_{};         // bytes of sampled cells by the position of their last expansion
  std::array<double, 64 * needs_per_octave> needs_{};  // repeated expansions by the budget that would have saved them
};

}  // namespace meristem
