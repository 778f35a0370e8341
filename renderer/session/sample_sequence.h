// The samples of a film when many are under way at once: what is taken next, and how those that come back out of order
// enter the film in theirs. So a film that is stopped at any time has of each pixel the first samples, and can be gone
// on from. Each class is of one thread at a time.
#pragma once

#include "renderer/film/film.h"
#include "renderer/session/camera_paths.h"

#include <unordered_map>
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

 private:
  PixelWindow window_;
  std::uint32_t first_sample_;
  std::vector<std::uint32_t> pixels_;  // in their order
  std::vector<std::uint32_t> taken_;   // by pixel
  std::vector<std::uint8_t> finished_;
  std::uint32_t round_ = 0, end_ = 0;
  std::size_t position_ = 0;
};

class SampleOrder {
 public:
  // The film must outlive it.
  SampleOrder(Film& film, std::uint32_t first_sample) : film_(film), first_sample_(first_sample) {}

  // Adds a sample, and those that waited for it; or keeps it until its predecessors have come. Returns how many were
  // added. `sample.first` is copied.
  std::uint32_t add(const PixelSample& at, const FilmSample& sample);

 private:
  struct Kept {
    FilmSample sample;
    FirstSurface first;
  };
  Film& film_;
  const std::uint32_t first_sample_;
  std::unordered_map<std::uint64_t, std::vector<Kept>> kept_;  // by pixel; few
};

}  // namespace meristem
