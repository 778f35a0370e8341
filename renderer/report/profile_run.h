// One recorded render, in a process of its own, for `meristem profile`.
#pragma once

#include "geometry/base/value.h"

#include <string>
#include <vector>

namespace meristem {

struct ProfileRunOptions {
  std::string program = "/proc/self/exe";  // that understands `render`
  std::string scene;
  std::vector<std::string> render_options;  // passed on
  std::string trace;                        // Chrome trace; empty: none
  std::string command;                      // of the user; the statistics tell it
};

struct ProfileRun {
  int exit_code = 0;
  Value statistics;  // as `render --stats` writes them; null if there is no image
  Value page_data;   // for report_page()
};

// Throws FileError.
ProfileRun run_profile(const ProfileRunOptions& options);

}  // namespace meristem
