// `meristem merge`: films of the same image with other samples become one, as if it had been rendered at once.
#pragma once

#include "renderer/cli/outputs.h"

#include <string>
#include <vector>

namespace meristem {

struct MergeOptions {
  std::vector<std::string> films;
  OutputOptions outputs;
  std::string command_line;  // for metadata
  bool quiet = false;
};

// Returns an exit code. Throws UsageError if the films do not belong together, FileError.
int merge_command(const MergeOptions& options);

}  // namespace meristem
