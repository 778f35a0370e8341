// What OpenImageIO's calls returned, as errors. For the .cpp files of this folder.
#pragma once

#include "renderer/image/atomic_file.h"

#include <fmt/format.h>

#include <string>

namespace meristem {

// Some plug-ins report success and leave the reason in geterror() alone: it is asked whatever the calls returned.
template <class File>
void check_success(File& file, bool success, const char* what, const std::string& path) {
  const std::string reason = file.geterror();
  if (!success || !reason.empty())
    throw FileError(fmt::format("cannot {} {}: {}", what, path, reason.empty() ? "unknown reason" : reason));
}

}  // namespace meristem
