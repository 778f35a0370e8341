// Runs a program and waits for it. Its standard streams are those of this process. While it runs, SIGINT from the
// terminal is left to the child, whose exit code tells of it.
#pragma once

#include <string>
#include <vector>

namespace meristem {

// `arguments[0]` is the program, a path. Returns its exit code, or 128 plus the signal that ended it. Throws
// std::runtime_error if it cannot be started. Call from one thread at a time.
int run_child(const std::vector<std::string>& arguments);

}  // namespace meristem
