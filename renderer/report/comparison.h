// The lazy, eager and flat renderings of one scene against each other: time, memory, faces, and whether the image is
// the same.
//
// Each rendering is a process of its own, so that its peak memory is its own; the modes take turns, so that a machine
// that slows down slows all of them. Figures are medians over the runs. Images are compared in 32-bit floats.
#pragma once

#include "renderer/report/image_difference.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace meristem {

struct ComparisonOptions {
  std::string program = "/proc/self/exe";  // that understands `render`
  std::string scene;
  std::vector<std::string> render_options;  // passed on to every rendering
  int runs = 1;
  std::function<void(const std::string& mode, int run)> starting = {};  // called before each rendering; run from 1
};

struct ModeFigures {
  std::string mode;
  int exit_code = 0;  // the first that was neither 0 nor 3 (a limit was reached); then the rest may be missing
  int runs = 0;       // that gave an image
  double first_pixel_s = 0, wall_s = 0, load_s = 0, render_s = 0;
  std::uint64_t peak_rss_bytes = 0, faces = 0, cells = 0;
  bool faults = false;                             // a run ended with exit code 3: a limit was reached or cells failed
  bool reproducible = true;                        // all runs gave the same bits
  std::optional<ImageDifference> difference = {};  // from lazy; not of lazy itself
};

struct Comparison {
  std::string scene;
  std::uint64_t pixels = 0;
  std::vector<ModeFigures> modes;  // lazy, eager, flat

  // The first failed mode's; else 3 if one had faults; else 0.
  int exit_code() const;
};

// Stops at the first rendering that was interrupted. Throws FileError if the system gives no temporary folder.
Comparison compare_modes(const ComparisonOptions& options);

std::string comparison_table(const Comparison& comparison);
std::string comparison_json(const Comparison& comparison);

}  // namespace meristem
