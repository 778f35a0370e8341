// Interruption: while one lives, the first SIGINT or SIGTERM asks the render to stop, so that the image so far can be
// written; a second SIGINT within two seconds ends the process at once (exit code 130, files untouched). SIGHUP and
// SIGUSR1 ask for a snapshot: files are written and the render goes on. SIGPIPE is ignored, so that a closed pipe is an
// error like any other. The handlers set flags and nothing else. One at a time, in the thread of the command line;
// signals belong to the process, so its flags do too.
#pragma once

#include <array>
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
  // Whether a snapshot was asked for since the last call.
  bool take_snapshot_request() const;

 private:
  static constexpr std::array handled{SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGPIPE};
  std::array<struct sigaction, handled.size()> old_{};
};

}  // namespace meristem
