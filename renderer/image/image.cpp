#include "renderer/image/image.h"

#include "geometry/base/check.h"
#include "renderer/image/image_codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

namespace meristem {

namespace {

constexpr float max_half = 65504.0f;

// The first `kept` of the image's channels, clamped; counts the values that were outside. NaN passes.
Image clamped_channels(const Image& image, int kept, float low, float high, std::size_t& outside) {
  std::vector<float> values;
  values.reserve(image.pixels.size());
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (int(i % std::size_t(image.channels)) >= kept) continue;
    const float value = image.pixels[i];
    outside += value < low || value > high;
    values.push_back(std::isnan(value) ? value : std::clamp(value, low, high));
  }
  return {image.width, image.height, kept, std::move(values)};
}

}  // namespace

Image read_image(const std::string& path, const std::string& part) { return image_codec().read(path, part); }

ImageFormat image_format(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  if (extension == ".exr") return ImageFormat::Exr;
  if (extension == ".png") return ImageFormat::Png;
  if (extension == ".jpg" || extension == ".jpeg") return ImageFormat::Jpeg;
  if (extension == ".tif" || extension == ".tiff") return ImageFormat::Tiff;
  throw FileError(fmt::format("cannot write {}: the name must end in .exr, .png, .jpg or .tif", path));
}

std::size_t write_image(const std::string& path, const Image& image, const Metadata& metadata,
                        const WriteOptions& options) {
  CHECK(image.width > 0 && image.height > 0, "an image of {} x {} pixels", image.width, image.height);
  CHECK(image.channels == 1 || image.channels == 3 || image.channels == 4, "{} channels", image.channels);
  CHECK(image.pixels.size() == std::size_t(image.width) * std::size_t(image.height) * std::size_t(image.channels),
        "{} values for {} x {} x {}", image.pixels.size(), image.width, image.height, image.channels);
  const ImageFormat format = image_format(path);
  std::size_t clamped = 0;
  std::vector<unsigned char> bytes;
  auto encode = [&](const Image& values) { bytes = image_codec().encode(path, format, values, metadata, options); };
  if (format != ImageFormat::Exr) {
    std::size_t outside_display = 0;
    encode(clamped_channels(image, std::min(image.channels, 3), 0, 1, outside_display));
  } else if (options.half) {
    encode(clamped_channels(image, image.channels, -max_half, max_half, clamped));
  } else {
    encode(image);
  }
  write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  return clamped;
}

}  // namespace meristem
