#include "renderer/report/temporary_folder.h"

#include "renderer/image/atomic_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace meristem {

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "meristem-XXXXXX").string();
  if (!::mkdtemp(name.data())) throw FileError(fmt::format("cannot make {}: {}", name, std::strerror(errno)));
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace meristem
