// What the process holds, as the kernel counts it.
#pragma once

#include <unistd.h>

#include <cstddef>
#include <fstream>

namespace meristem {

inline std::size_t resident_set_bytes() {
  std::size_t size = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> size >> resident;
  return resident * std::size_t(sysconf(_SC_PAGESIZE));
}

}  // namespace meristem
