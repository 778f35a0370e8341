// `meristem export`: the expanded geometry of a scene as a mesh file for other programs.
#pragma once

#include "renderer/cli/render_command.h"

#include <string>

namespace meristem {

struct ExportOptions {
  std::string scene;
  std::string output;  // .obj, .ply or .glb
  LoadOptions load;
  bool quiet = false;
};

int export_command(const ExportOptions& options, const SceneLoader& load);

}  // namespace meristem
