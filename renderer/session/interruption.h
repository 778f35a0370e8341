// Interruption: while one lives, the first SIGINT or SIGTERM asks the render to stop, so that the image so far can be
// written; a second SIGINT within two seconds ends the process at once (exit code 130, files untouched). The handler
// sets a flag and nothing else. One at a time, in the thread of the command line; signals belong to the process, so its
// flags do too.
#pragma once

#include <atomic>

#include <signal.h>

namespace meristem {

class Interruption {
 public:
  Interruption();
  ~Interruption();  // the former handlers return
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  // Set by the first signal.
  const std::atomic<bool>& requested() const;
  // The signal that came first, or 0.
  int signal() const;

 private:
  struct sigaction old_interrupt_ {
  }, old_terminate_{};
};

}  // namespace meristem
