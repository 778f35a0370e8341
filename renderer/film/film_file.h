// Film files: a film as it stands, every sum exact, so that a render can go on from it or films can be merged as if
// they had never been apart. They serve as checkpoints (`--checkpoint`), as parts (`-o part.film`), and as the input of
// `meristem merge`.
//
// Binary, little-endian, sections each with a CRC-32; not compressed. The file appears whole or not at all, and is read
// back and compared before it takes its place. Reading trusts nothing: a damaged or foreign file is a FileError.
#pragma once

#include "renderer/film/film.h"
#include "renderer/scene/scene.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace meristem {

// The numbers of a pixel's samples, [first, last).
struct SampleRange {
  std::uint32_t first = 0, last = 0;
  bool operator==(const SampleRange&) const = default;
};

// What is known of a film beside its pixels.
struct FilmInfo {
  // What the samples depend on, by name: scene, files, settings. Films with the same identity may be merged.
  std::vector<std::pair<std::string, std::string>> identity;
  std::vector<SampleRange> ranges;  // sorted
  int frame_width = 0, frame_height = 0;
  SceneNames names;
  Metadata metadata;                 // for images made of the film
  std::vector<std::string> history;  // a line for each run that added samples
};

// What adaptive sampling has decided so far.
struct AdaptiveState {
  std::uint32_t decided_at = 0;        // the number of samples at the last decision
  std::vector<std::uint8_t> finished;  // of each pixel: takes no more samples; empty: none is
};

struct FilmFile {
  FilmInfo info;
  Film film;
  AdaptiveState adaptive;
};

void write_film_file(const std::string& path, const Film& film, const FilmInfo& info, const AdaptiveState& adaptive);
FilmFile read_film_file(const std::string& path);

}  // namespace meristem
