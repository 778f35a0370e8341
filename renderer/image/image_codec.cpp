#include "renderer/image/image_codec.h"

#include <fmt/format.h>

#include <filesystem>

#include <dlfcn.h>

namespace meristem {

namespace fs = std::filesystem;

namespace {

constexpr const char* module_name = "meristem_image.so";

fs::path module_path() {
  const fs::path folder = fs::read_symlink("/proc/self/exe").parent_path();
  for (const fs::path& place : {folder, folder.parent_path()})
    if (fs::path path = place / module_name; fs::exists(path)) return path;
  throw FileError(fmt::format("cannot read or write images: {} is missing from {}", module_name, folder.string()));
}

const ImageCodec& open_module() {
  const std::string path = module_path().string();
  void* const module = ::dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
  void* const entry = module ? ::dlsym(module, "meristem_image_codec") : nullptr;
  if (!entry) throw FileError(fmt::format("cannot read or write images: {}", ::dlerror()));
  return *reinterpret_cast<decltype(&meristem_image_codec)>(entry)();
}

}  // namespace

const ImageCodec& image_codec() {
  static const ImageCodec& codec = open_module();
  return codec;
}

void check_image_support() { module_path(); }

void open_image_support() noexcept {
  try {
    image_codec();
  } catch (const FileError&) {  // whoever reads or writes will hear of it
  }
}

}  // namespace meristem
