#include "renderer/image/image.h"

#include "geometry/base/check.h"
#include "renderer/image/exr_parts.h"
#include "renderer/image/image_codec.h"
#include "renderer/image/png_encoder.h"
#include "renderer/image/quantizer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace meristem {

namespace {

// Its first `kept` channels, on the steps of the file.
Image display_channels(const Image& image, int kept, const Quantizer& quantizer) {
  Image steps{image.width, image.height, kept, {}};
  steps.pixels.reserve(std::size_t(image.width) * std::size_t(image.height) * std::size_t(kept));
  const float* pixel = image.pixels.data();
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x, pixel += image.channels)
      for (int c = 0; c < kept; ++c)
        steps.pixels.push_back(float(quantizer.step(pixel[c], x, y, c)) / float(quantizer.last()));
  return steps;
}

std::vector<std::string> channel_names(int channels) {
  if (channels == 1) return {"Y"};
  if (channels == 3) return {"R", "G", "B"};
  return {"R", "G", "B", "A"};
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
  if (format == ImageFormat::Exr)
    return write_exr_parts(path, {{"", channel_names(image.channels), image, options.half, true}},
                           {0, 0, image.width, image.height}, metadata);
  if (format == ImageFormat::Png) {
    write_file(path, encode_png(path, image, metadata, options));
    return 0;
  }
  const Quantizer quantizer(format == ImageFormat::Jpeg ? 8 : options.bits, options);
  const std::vector<unsigned char> bytes = image_codec().encode(
      path, format, display_channels(image, std::min(image.channels, 3), quantizer), metadata, options);
  write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  return 0;
}

bool needs_module(ImageFormat format) { return format == ImageFormat::Jpeg || format == ImageFormat::Tiff; }

}  // namespace meristem
