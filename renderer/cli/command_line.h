// The command line: its options, its commands, and what their errors end as. Caught here and nowhere else.
#pragma once

#include "renderer/cli/render_command.h"

namespace meristem {

// Returns an exit code (exit_code.h). Never throws. `load` stands in for load_scene() in tests.
int run_command_line(int argc, const char* const* argv, const SceneLoader& load = load_scene);

}  // namespace meristem
