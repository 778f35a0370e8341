// Expanded geometry in huge pages. Rays jump about in hundreds of megabytes; in pages of 4 KB nearly every step misses
// the processor's buffer of page addresses. Where Linux gives huge pages only to those who ask for them, glibc's malloc
// asks if its tunable glibc.malloc.hugetlb is set when a program starts.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace meristem {

// The GLIBC_TUNABLES with which a program that has `tunables` (null: none) should be started instead; nothing if it may
// stay as it is: huge pages are everybody's or nobody's, or some of malloc's tunables have been set already. `mode`:
// the text of /sys/kernel/mm/transparent_hugepage/enabled.
std::optional<std::string> tunables_for_huge_pages(std::string_view mode, const char* tunables);

// For the first line of main(): starts the program anew, in the same process, if that gains huge pages. Some 2 ms; goes
// on as before if it cannot be done.
void restart_with_huge_pages(char** argv);

}  // namespace meristem
