#include "geometry/base/huge_pages.h"

#include <cstdlib>
#include <fstream>

#include <limits.h>
#include <unistd.h>

namespace meristem {

namespace {

constexpr const char* variable = "GLIBC_TUNABLES";
constexpr std::string_view malloc_tunables = "glibc.malloc.";
// A thread's heap grows by small pages as they are needed, each a call of the kernel and never part of a huge page,
// unless it is made 16 MiB larger at a time (top_pad); so much is kept at its end as well. A huge page is cleared when
// it is handed out, so arrays that come and go are better kept, too: none below 32 MiB is a mapping of its own.
constexpr std::string_view wanted =
    "glibc.malloc.hugetlb=1:glibc.malloc.mmap_threshold=33554432:glibc.malloc.top_pad=16777216:"
    "glibc.malloc.trim_threshold=8388608";

}  // namespace

std::optional<std::string> tunables_for_huge_pages(std::string_view mode, const char* tunables) {
  std::string result = tunables ? tunables : "";
  if (mode.find("[madvise]") == mode.npos || result.find(malloc_tunables) != result.npos) return {};
  if (!result.empty()) result += ':';
  return result.append(wanted);
}

void restart_with_huge_pages(char** argv) {
  std::string mode;
  std::getline(std::ifstream("/sys/kernel/mm/transparent_hugepage/enabled"), mode);
  const auto tunables = tunables_for_huge_pages(mode, std::getenv(variable));
  if (!tunables) return;
  char program[PATH_MAX] = {};  // not the link itself: it would become the name of the process
  if (::readlink("/proc/self/exe", program, sizeof(program) - 1) < 0) return;
  ::setenv(variable, tunables->c_str(), 1);
  ::execv(program, argv);
}

}  // namespace meristem
