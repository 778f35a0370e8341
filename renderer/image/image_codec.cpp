#include "renderer/image/image_codec.h"

#include "geometry/base/module.h"

#include <fmt/format.h>

namespace meristem {

namespace {

constexpr const char* module_name = "meristem_image.so";

template <class Function>
auto with_file_errors(const Function& f) {
  try {
    return f();
  } catch (const std::runtime_error& error) {
    throw FileError(fmt::format("cannot read or write images: {}", error.what()));
  }
}

const ImageCodec* open_codec() {
  void* const entry = with_file_errors([] { return open_module(module_name, "meristem_image_codec"); });
  return reinterpret_cast<decltype(&meristem_image_codec)>(entry)();
}

}  // namespace

const ImageCodec& image_codec() {
  static const ImageCodec* const codec = open_codec();
  return *codec;
}

void check_image_module() {
  with_file_errors([] { return module_path(module_name); });
}

void open_image_module() noexcept {
  try {
    image_codec();
  } catch (const FileError&) {  // whoever reads or writes will hear of it
  }
}

}  // namespace meristem
