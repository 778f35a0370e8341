// `meristem render`: from a scene file to images and figures.
#pragma once

#include "renderer/cli/exit_code.h"
#include "renderer/film/film.h"
#include "renderer/image/image.h"
#include "renderer/loading/load_scene.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace meristem {

// load_scene(), or what a test puts in its place.
using SceneLoader = std::function<LoadedScene(const std::string& path, const LoadOptions& options)>;

struct RenderOptions {
  std::string scene;
  std::vector<std::string> outputs;  // empty: the scene's name with .exr and .png in the current folder
  LoadOptions load;
  std::optional<PixelWindow> crop;
  std::string view;    // of display images; empty: the default
  float exposure = 0;  // stops, of display images
  WriteOptions write;
  std::string statistics;  // JSON file; empty: none
  bool quiet = false, verbose = false;
  std::string command_line;  // for metadata
};

// Whatever can be told to fail beforehand (folders, view, crop) fails before the rendering. Returns Done, Limit, or
// Interrupted plus the signal; throws SceneErrors, UsageError, ColorError, FileError.
int render_command(const RenderOptions& options, const SceneLoader& load);

}  // namespace meristem
