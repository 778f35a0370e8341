#include "renderer/session/process_clock.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>

#include <time.h>
#include <unistd.h>

namespace meristem {

namespace {

double clock_s(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return double(now.tv_sec) + double(now.tv_nsec) * 1e-9;
}
double boot_clock_s() { return clock_s(CLOCK_BOOTTIME); }

// Field 22 of /proc/self/stat (proc(5)), in seconds since boot: the middle of the hundredth that it names. Fields are
// counted after the name in parentheses, which may hold spaces.
std::optional<double> start_of_process_s() {
  std::ifstream in("/proc/self/stat");
  std::string line, field;
  if (!std::getline(in, line)) return std::nullopt;
  std::istringstream fields(line.substr(line.rfind(')') + 1));
  for (int i = 3; i <= 22; ++i)
    if (!(fields >> field)) return std::nullopt;
  return (std::stod(field) + 0.5) / double(::sysconf(_SC_CLK_TCK));
}

// Read once, when the library is initialised; by then the process is as old at least as the time it has run. A system
// whose clocks disagree (some containers) gets that moment.
double process_start_s() {
  const double now = boot_clock_s();
  const double start = std::min(start_of_process_s().value_or(now), now - clock_s(CLOCK_PROCESS_CPUTIME_ID));
  return start <= now && now - start < 60 ? start : now;
}

// A field of /proc/self/status that is given in kB.
std::uint64_t status_bytes(const std::string& field) {
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with(field)) return std::stoull(line.substr(field.size())) * 1024;
  return 0;
}

const double started_s = process_start_s();

}  // namespace

double process_age_s() { return boot_clock_s() - started_s; }

std::uint64_t peak_resident_bytes() { return status_bytes("VmHWM:"); }

}  // namespace meristem
