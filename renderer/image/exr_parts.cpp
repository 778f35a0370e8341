#include "renderer/image/exr_parts.h"

#include "geometry/base/check.h"
#include "renderer/image/image_codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

constexpr float max_half = 65504.0f;

void check_part(const ExrPart& part, const Image& first) {
  const Image& image = part.image;
  CHECK(image.width == first.width && image.height == first.height, "part {} has another size", part.name);
  CHECK(part.channels.size() == std::size_t(image.channels), "part {} has {} channels and {} names", part.name,
        image.channels, part.channels.size());
  CHECK(image.pixels.size() == std::size_t(image.width) * std::size_t(image.height) * part.channels.size(),
        "part {} has {} values", part.name, image.pixels.size());
}

// NaN passes.
void clamp_to_half(std::vector<float>& values, std::size_t& outside) {
  for (float& value : values) {
    outside += value < -max_half || value > max_half;
    if (!std::isnan(value)) value = std::clamp(value, -max_half, max_half);
  }
}

}  // namespace

std::size_t write_exr_parts(const std::string& path, std::vector<ExrPart> parts, const ExrFrame& frame,
                            const Metadata& metadata) {
  CHECK(!parts.empty(), "an EXR file without parts");
  std::size_t outside = 0;
  for (ExrPart& part : parts) {
    check_part(part, parts[0].image);
    if (part.half) clamp_to_half(part.image.pixels, outside);
  }
  const std::vector<unsigned char> bytes = image_codec().encode_parts(path, parts, frame, metadata);
  write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  return outside;
}

}  // namespace meristem
