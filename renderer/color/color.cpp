#include "renderer/color/color.h"

#include "geometry/base/check.h"
#include "geometry/base/module.h"
#include "renderer/color/color_management.h"

#include <fmt/format.h>

namespace meristem {

namespace {

const ColorManagement* open_management() {
  try {
    void* const entry = open_module("meristem_color.so", "meristem_color_management");
    return reinterpret_cast<decltype(&meristem_color_management)>(entry)();
  } catch (const std::runtime_error& error) {
    throw ColorError(fmt::format("cannot make display images: {}", error.what()));
  }
}

const ColorManagement& management() {
  static const ColorManagement* const opened = open_management();
  return *opened;
}

}  // namespace

DisplayTransform::DisplayTransform(const std::string& view, float exposure, const std::string& display)
    : transform_(management().display_transform(view, exposure, display)) {}

DisplayTransform::~DisplayTransform() = default;
DisplayTransform::DisplayTransform(DisplayTransform&&) noexcept = default;

void DisplayTransform::apply(float* pixels, int width, int height, int channels) const {
  CHECK(channels == 3 || channels == 4, "{} channels", channels);
  transform_->apply(pixels, width, height, channels);
}

bool DisplayTransform::is_data() const { return transform_->is_data(); }

std::vector<std::string> DisplayTransform::views() { return management().views(); }

}  // namespace meristem
