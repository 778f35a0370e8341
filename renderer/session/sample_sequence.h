// The samples of a film when many are under way at once: what is taken next, and how those that come back out of order
// enter the film in theirs. Sums would need no order. But a film that is stopped at any time has of each pixel the
// first samples, so it can be gone on from by a count, and is no darker where paths are long: of those under way the
// short ones come back first. Each class is of one thread at a time.
#pragma once

#include "renderer/film/film.h"
#include "renderer/session/block_array.h"
#include "renderer/session/camera_paths.h"

#include <atomic>
#include <vector>

namespace meristem {

// Sample after sample, each of all pixels in the order given: pixels lag behind no others.
class SampleSequence {
 public:
  // Goes on from the samples that the film has. Numbers count from `first_sample`.
  SampleSequence(const Film& film, const std::vector<PixelWindow>& tiles, std::uint32_t first_sample);

  // Up to so many samples a pixel, but none of those for which `is_finished` (may be empty; as AdaptiveState has it).
  void extend(std::uint32_t end, const std::vector<std::uint8_t>& is_finished);
  bool next(PixelSample& sample);
  std::size_t bytes() const {
    return tiles_.capacity() * sizeof(PixelWindow) + had_.capacity() * sizeof(std::uint32_t) + finished_.capacity();
  }

 private:
  bool is_due(std::size_t pixel) const {
    return (had_.empty() || had_[pixel] <= round_) && (finished_.empty() || !finished_[pixel]);
  }
  void begin_tile(std::size_t tile);
  void begin_round();

  PixelWindow window_;
  std::vector<PixelWindow> tiles_;  // none empty
  std::uint32_t first_sample_;
  std::vector<std::uint32_t> had_;  // by pixel, what the film had; empty once no pixel is ahead
  std::uint32_t most_had_ = 0;
  std::vector<std::uint8_t> finished_;
  std::uint32_t round_ = 0, end_ = 0;
  std::size_t tile_ = 0;
  int x_ = 0, y_ = 0;  // the next pixel
};

class SampleOrder {
 public:
  // The film must outlive it.
  SampleOrder(Film& film, std::uint32_t first_sample) : film_(film), first_sample_(first_sample) {}

  // Adds a sample, and those that waited for it; or keeps of it what the film wants until its predecessors have come.
  // Returns how many were added.
  std::uint32_t add(const PixelSample& at, const FilmSample& sample);
  // Of those that are kept, at most so far: what is free of it is used again. Any thread.
  std::size_t bytes() const { return bytes_.load(std::memory_order_relaxed); }

 private:
  using Index = std::uint32_t;
  static constexpr Index none = ~Index(0);
  struct Kept {
    Spectrum radiance;
    std::uint32_t number;
    Index next;  // of its pixel, or of those that are free
    std::int8_t weight;
    bool covered;
  };
  // By the same index, if the film wants them
  struct Surface {
    FirstSurface first;
    float depth;
    Vec2f motion;
  };
  struct Cost {
    std::uint64_t nanoseconds;
    ThreadExpansions expansions;
  };
  void keep(std::size_t pixel, const FilmSample& sample);
  FilmSample kept(Index i) const;
  void count_bytes();

  Film& film_;
  const std::uint32_t first_sample_;
  BlockArray<Kept> kept_;  // and those that are free again
  BlockArray<Surface> surfaces_;
  BlockArray<Cost> costs_;
  Index free_ = none;
  std::vector<Index> first_kept_;  // by pixel; empty before there is one
  std::atomic<std::size_t> bytes_{0};
};

}  // namespace meristem
