#include "geometry/base/module.h"

#include <fmt/format.h>

#include <stdexcept>

#include <dlfcn.h>

namespace meristem {

namespace fs = std::filesystem;

fs::path module_path(const char* file) {
  const fs::path folder = fs::read_symlink("/proc/self/exe").parent_path();
  for (const fs::path& place : {folder, folder.parent_path()})
    if (fs::path path = place / file; fs::exists(path)) return path;
  throw std::runtime_error(fmt::format("{} is missing from {}", file, folder.string()));
}

void* open_module(const char* file, const char* entry) {
  const std::string path = module_path(file).string();
  void* const module = ::dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
  void* const address = module ? ::dlsym(module, entry) : nullptr;
  if (!address) throw std::runtime_error(::dlerror());
  return address;
}

}  // namespace meristem
