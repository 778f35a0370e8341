// EXR files of one part or several: the picture and what else is known of each pixel. Every part has the same data
// window. By OpenEXR's core library, whose blocks of rows ("zip") are compressed on all threads; the bytes do not
// depend on their number. Any thread; every error is a FileError that names the file; the file appears whole or not at
// all.
#pragma once

#include "renderer/image/image.h"

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace meristem {

// What the rows of a part hold, as they are asked for: no part has to lie in memory as a whole.
struct ExrRows {
  // Writes rows from `begin` up to `end`, channels interleaved. Called by several threads at once.
  using Fill = std::function<void(int begin, int end, float* values)>;

  ExrRows(int width_, int height_, Fill fill_) : width(width_), height(height_), fill(std::move(fill_)) {}
  // Of an image, which it keeps.
  ExrRows(Image image);

  int width, height;
  Fill fill;
};

struct ExrPart {
  std::string name;
  std::vector<std::string> channels;
  ExrRows rows;
  bool half = false;  // 16-bit halves; else 32-bit floats
  bool color = true;  // scene-linear Rec.709, and says so; else data
  Metadata metadata = {};
};

// Where the data window lies in the full frame.
struct ExrFrame {
  int x = 0, y = 0, full_width = 0, full_height = 0;
};

// Returns how many values of parts of halves lay outside the range of a half and were clamped to it. `metadata` goes to
// the first part.
std::size_t write_exr_parts(const std::string& path, const std::vector<ExrPart>& parts, const ExrFrame& frame,
                            const Metadata& metadata = {});

}  // namespace meristem
