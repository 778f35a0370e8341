// What the exit codes of the program mean; `meristem --help` lists them.
#pragma once

#include <stdexcept>

namespace meristem {

enum class ExitCode {
  Done = 0,
  Internal = 1,      // a bug of ours
  Usage = 2,         // the command line or the scene is wrong
  Limit = 3,         // a limit was reached or something broke while rendering; the image was written
  File = 4,          // a file could not be read or written
  Interrupted = 128  // plus the signal: 130 for SIGINT, 143 for SIGTERM; the image so far was written
};

// The user asked for something that does not go together; the message says what would.
class UsageError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace meristem
