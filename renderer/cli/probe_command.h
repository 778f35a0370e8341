// `meristem probe`: what one pixel shows, and what each of its rays costs.
#pragma once

#include "renderer/cli/render_command.h"

#include <string>

namespace meristem {

struct ProbeOptions {
  std::string scene;
  int x = 0, y = 0;  // pixel
  int samples = 1;
  LoadOptions load;
};

int probe_command(const ProbeOptions& options, const SceneLoader& load);

}  // namespace meristem
