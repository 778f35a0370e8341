// `meristem render`: from a scene file to images and figures.
#pragma once

#include "renderer/cli/exit_code.h"
#include "renderer/cli/outputs.h"
#include "renderer/loading/load_scene.h"
#include "renderer/session/progress.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace meristem {

// load_scene(), or what a test puts in its place.
using SceneLoader = std::function<LoadedScene(const std::string& path, const LoadOptions& options)>;

struct RenderOptions {
  std::string scene;
  OutputOptions outputs;  // no files: the scene's name with .exr and .png in the current folder
  LoadOptions load;
  std::optional<PixelWindow> crop;
  std::optional<SampleRange> sample_range;  // else from 0 to the number of samples
  std::optional<double> time_limit_s;
  std::optional<double> checkpoint_s;              // write the images and a film file so often
  bool resume = false;                             // go on from the film file if there is one
  std::vector<int> frames;                         // empty: one image
  std::string statistics;                          // JSON file; empty: none
  std::string trace;                               // Chrome trace; empty: none
  bool profile = false;                            // the statistics then hold what was recorded; implied by `trace`
  std::optional<ProgressDisplay::Style> progress;  // none: what suits standard error
  bool quiet = false, verbose = false;
  std::string command_line;  // for metadata
};

// Whatever can be told to fail beforehand (folders, view, crop) fails before the rendering. Returns Done, Limit, or
// Interrupted plus the signal; throws SceneErrors, UsageError, ColorError, FileError.
int render_command(const RenderOptions& options, const SceneLoader& load);

}  // namespace meristem
