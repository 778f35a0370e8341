// The codec of image_codec.h upon OpenImageIO: the one place that includes it.
#include "renderer/image/codec/memory_file.h"
#include "renderer/image/codec/oiio_result.h"
#include "renderer/image/codec/oiio_texture.h"
#include "renderer/image/image_codec.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>

namespace meristem {

namespace {

constexpr int max_side = 65536;
constexpr int max_channels = 64;
constexpr std::uint64_t max_decoded_bytes = std::uint64_t(2) << 30;

struct Magic {
  std::string_view bytes;
  const char* format;  // OpenImageIO's name
};

using namespace std::string_view_literals;
constexpr std::array magics{Magic{"\x76\x2f\x31\x01"sv, "openexr"},
                            Magic{"\x89PNG\r\n\x1a\n"sv, "png"},
                            Magic{"\xff\xd8\xff"sv, "jpeg"},
                            Magic{"#?RADIANCE"sv, "hdr"},
                            Magic{"#?RGBE"sv, "hdr"},
                            Magic{"II*\0"sv, "tiff"},
                            Magic{"MM\0*"sv, "tiff"},
                            Magic{"II+\0"sv, "tiff"},
                            Magic{"MM\0+"sv, "tiff"}};

std::string first_bytes(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw FileError(fmt::format("cannot read {}: no such file", path));
  if (!std::filesystem::is_regular_file(status))
    throw FileError(fmt::format("cannot read {}: it is not a regular file", path));
  std::ifstream in(path, std::ios::binary);
  std::string bytes(16, '\0');
  if (!in) throw FileError(fmt::format("cannot read {}: {}", path, std::strerror(errno)));
  in.read(bytes.data(), std::streamsize(bytes.size()));
  bytes.resize(std::size_t(in.gcount()));
  return bytes;
}

const char* format_of_content(const std::string& path) {
  const std::string bytes = first_bytes(path);
  for (const Magic& magic : magics)
    if (bytes.starts_with(magic.bytes)) return magic.format;
  throw FileError(fmt::format("cannot read {}: not an EXR, PNG, JPEG, Radiance HDR or TIFF image", path));
}

void check_limits(const OIIO::ImageSpec& spec, const std::string& path) {
  if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1 || spec.depth > 1 || spec.deep)
    throw FileError(fmt::format("cannot read {}: not a flat two-dimensional image", path));
  if (spec.width > max_side || spec.height > max_side)
    throw FileError(
        fmt::format("cannot read {}: {} x {} pixels; the limit is {} a side", path, spec.width, spec.height, max_side));
  if (spec.nchannels > max_channels)
    throw FileError(fmt::format("cannot read {}: {} channels; the limit is {}", path, spec.nchannels, max_channels));
  const std::uint64_t bytes =
      std::uint64_t(spec.width) * std::uint64_t(spec.height) * std::uint64_t(spec.nchannels) * sizeof(float);
  if (bytes > max_decoded_bytes)
    throw FileError(
        fmt::format("cannot read {}: {} MiB decoded; the limit is {} MiB", path, bytes >> 20, max_decoded_bytes >> 20));
}

OIIO::TypeDesc file_type(ImageFormat format, const WriteOptions& options) {
  return options.bits == 16 && format != ImageFormat::Jpeg ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8;
}

OIIO::ImageSpec file_spec(ImageFormat format, const Image& image, const Metadata& metadata,
                          const WriteOptions& options) {
  OIIO::ImageSpec spec(image.width, image.height, image.channels, file_type(format, options));
  for (const auto& [name, value] : metadata) spec.attribute(name, value);
  if (format == ImageFormat::Jpeg) spec.attribute("Compression", "jpeg:95");
  spec.attribute("oiio:ColorSpace", "sRGB");
  return spec;
}

const char* plugin_name(ImageFormat format) { return format == ImageFormat::Jpeg ? "jpeg" : "tiff"; }

void run_encoder(OIIO::ImageOutput& out, const std::string& name, const std::string& path, const OIIO::ImageSpec& spec,
                 const float* pixels) {
  check_success(out, out.open(name, spec), "write", path);
  check_success(out, out.write_image(OIIO::TypeDesc::FLOAT, pixels), "write", path);
  check_success(out, out.close(), "write", path);
}

// Opens a file of a known format and within the limits.
std::unique_ptr<OIIO::ImageInput> open_checked(const std::string& path, OIIO::ImageSpec& spec) {
  std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::create(format_of_content(path));
  if (!in) throw FileError(fmt::format("cannot read {}: OpenImageIO has no reader for it here", path));
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);  // else PNG values come multiplied by alpha, in display encoding
  check_success(*in, in->open(path, spec, config), "read", path);
  check_limits(spec, path);
  return in;
}

// Moves on to the part of that name.
void seek_part(OIIO::ImageInput& in, const std::string& part, const std::string& path) {
  for (int i = 0; in.seek_subimage(i, 0); ++i)
    if (in.spec().get_string_attribute("oiio:subimagename") == part) return;
  throw FileError(fmt::format("cannot read {}: it has no part \"{}\"", path, part));
}

class OiioCodec final : public ImageCodec {
 public:
  Image read(const std::string& path, const std::string& part) const override {
    OIIO::ImageSpec spec;
    const std::unique_ptr<OIIO::ImageInput> in = open_checked(path, spec);
    if (!part.empty()) {
      seek_part(*in, part, path);
      spec = in->spec();
      check_limits(spec, path);
    }
    Image image{spec.width, spec.height, spec.nchannels, {}};
    image.pixels.resize(std::size_t(spec.width) * std::size_t(spec.height) * std::size_t(spec.nchannels));
    check_success(
        *in, in->read_image(in->current_subimage(), 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.pixels.data()),
        "read", path);
    return image;
  }

  // Not written to the disk by the libraries: on a full disk libjpeg ends the process.
  std::vector<unsigned char> encode(const std::string& path, ImageFormat format, const Image& image,
                                    const Metadata& metadata, const WriteOptions& options) const override {
    const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(plugin_name(format));
    if (!out)
      throw FileError(fmt::format("cannot write {}: OpenImageIO has no {} writer here", path, plugin_name(format)));
    const OIIO::ImageSpec spec = file_spec(format, image, metadata, options);
    if (format == ImageFormat::Tiff) {
      const MemoryFile file;
      run_encoder(*out, file.path(), path, spec, image.pixels.data());
      return file.content();
    }
    OIIO::Filesystem::IOVecOutput memory;
    out->set_ioproxy(&memory);
    run_encoder(*out, path, path, spec, image.pixels.data());
    return std::move(memory.buffer());
  }

  std::unique_ptr<const Texture> open_texture(const std::string& path, const TextureOptions& options) const override {
    OIIO::ImageSpec spec;
    open_checked(path, spec);
    return make_oiio_texture(path, options);
  }

  std::vector<std::string> texture_faults() const override { return oiio_texture_faults(); }
};

}  // namespace
}  // namespace meristem

extern "C" const meristem::ImageCodec* meristem_image_codec() {
  static const meristem::OiioCodec codec;
  return &codec;
}
