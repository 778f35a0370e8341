// Renderings of one scene against each other: lazily, at one budget or several, eagerly, and flat; time, memory, cells,
// and whether the image is the same.
//
// Each rendering is a process of its own, so that its peak memory is its own; they take turns, so that a machine that
// slows down slows all of them. Images are compared in 32-bit floats, and by FLIP as they are shown.
#pragma once

#include "geometry/base/value.h"
#include "renderer/image/image.h"
#include "renderer/report/image_difference.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace meristem {

// A budget of the geometry cache, or a share of what the scene's expanded geometry takes when nothing is evicted.
struct BudgetChoice {
  std::uint64_t bytes = 0;  // if not 0
  double share = 0;
};

struct ComparisonOptions {
  std::string program = "/proc/self/exe";  // that understands `render`
  std::string scene;
  std::vector<std::string> render_options;  // passed on to every rendering
  int runs = 1;
  std::vector<BudgetChoice> budgets =
      {};               // none: lazy alone, with the scene's own; else lazy without limit, then these
  bool record = false;  // render each once more, lazy and eager, for its statistics; untimed
  std::function<void(const std::string& name, int run)> starting =
      {};  // before each rendering; run from 1, 0: recorded
};

// What one rendering wrote of itself.
struct RunFigures {
  double first_pixel_s = 0, wall_s = 0, load_s = 0, render_s = 0;
  std::uint64_t peak_rss_bytes = 0, resident_bytes_peak = 0, faces = 0, cells = 0;
  std::string image_sha256;
};

struct Variant {
  std::string name;          // "lazy", "lazy 25 %", "eager", "flat"
  std::string mode;          // "lazy", "eager", "flat"
  BudgetChoice budget = {};  // if one was chosen; bytes are known once the first has run
  int exit_code = 0;         // the first that was neither 0 nor 3 (a limit was reached); the rest may be missing
  std::vector<RunFigures> runs = {};               // that gave an image
  bool faults = false;                             // a run ended with exit code 3: a limit was reached or cells failed
  std::optional<ImageDifference> difference = {};  // from the first; not of the first itself
  double flip_mean = 0;                            // the same by FLIP
  std::optional<Image> shown = {}, flip = {};      // as displayed; FLIP by pixel, if they differ
  std::optional<Value> statistics = {};            // of the recorded rendering

  double median(double RunFigures::*figure) const;
  std::uint64_t median(std::uint64_t RunFigures::*figure) const;
  bool reproducible() const;  // all runs gave the same bits
};

struct Comparison {
  std::string scene;
  std::uint64_t pixels = 0;
  std::vector<Variant> variants;  // lazy, at its budgets, eager, flat

  // The first failed one's; else 3 if one had faults; else 0.
  int exit_code() const;
};

// Stops at the first rendering that was interrupted. Throws FileError if the system gives no temporary folder.
Comparison compare_modes(const ComparisonOptions& options);

std::string comparison_table(const Comparison& comparison);
std::string comparison_json(const Comparison& comparison);

// What the comparison shows, in words.
std::vector<std::string> comparison_words(const Comparison& comparison);
// For report_page().
Value comparison_page_data(const Comparison& comparison, const std::string& command);

// A file that `meristem render --stats` wrote. Throws SceneErrors if it cannot be read.
Value read_statistics(const std::string& path);

}  // namespace meristem
