#include "geometry/base/process_memory.h"

#include <fstream>

#include <malloc.h>
#include <unistd.h>

namespace meristem {

void give_back_freed_memory() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

std::size_t resident_set_bytes() {
  std::size_t all = 0, resident = 0;  // pages
  std::ifstream("/proc/self/statm") >> all >> resident;
  return resident * std::size_t(::sysconf(_SC_PAGESIZE));
}

std::size_t machine_memory_bytes() {
  const long pages = ::sysconf(_SC_PHYS_PAGES);
  return pages > 0 ? std::size_t(pages) * std::size_t(::sysconf(_SC_PAGESIZE)) : 0;
}

}  // namespace meristem
