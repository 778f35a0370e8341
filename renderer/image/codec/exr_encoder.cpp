#include "renderer/image/codec/exr_encoder.h"

#include "renderer/image/codec/memory_file.h"
#include "renderer/image/codec/oiio_result.h"

#include <OpenImageIO/imageio.h>

#include <array>
#include <memory>

namespace meristem {

namespace {

OIIO::ImageSpec part_spec(const ExrPart& part, const ExrFrame& frame) {
  const Image& image = part.image;
  OIIO::ImageSpec spec(image.width, image.height, image.channels,
                       part.half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
  spec.channelnames = part.channels;
  spec.x = frame.x;
  spec.y = frame.y;
  spec.full_width = frame.full_width;
  spec.full_height = frame.full_height;
  spec.attribute("compression", "zip");
  spec.attribute("oiio:subimagename", part.name);
  spec.attribute("oiio:ColorSpace", part.color ? "lin_srgb" : "Raw");
  // Rec.709 primaries and the white D65 (ITU-R BT.709-6, item 1.3).
  const std::array<float, 8> chromaticities{0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};
  if (part.color) spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), chromaticities.data());
  for (const auto& [name, value] : part.metadata) spec.attribute(name, value);
  return spec;
}

// Reads the last row of each part: what no longer fits is lost without an error.
void check_whole(const MemoryFile& file, const std::vector<OIIO::ImageSpec>& specs, const std::string& path) {
  const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::create("openexr");
  OIIO::ImageSpec spec;
  check_success(*in, in->open(file.path(), spec), "write", path);
  for (int i = 0; i < int(specs.size()); ++i) {
    const OIIO::ImageSpec& s = specs[std::size_t(i)];
    std::vector<float> row(std::size_t(s.width) * std::size_t(s.nchannels));
    const int last = s.y + s.height - 1;
    check_success(*in,
                  in->seek_subimage(i, 0) &&
                      in->read_scanlines(i, 0, last, last + 1, 0, 0, s.nchannels, OIIO::TypeDesc::FLOAT, row.data()),
                  "write", path);
  }
}

}  // namespace

std::vector<unsigned char> encode_exr_parts(const std::string& path, const std::vector<ExrPart>& parts,
                                            const ExrFrame& frame, const Metadata& metadata) {
  std::vector<OIIO::ImageSpec> specs;
  for (const ExrPart& part : parts) specs.push_back(part_spec(part, frame));
  for (const auto& [name, value] : metadata) specs[0].attribute(name, value);
  const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create("openexr");
  if (!out) throw FileError(fmt::format("cannot write {}: OpenImageIO has no openexr writer here", path));
  const MemoryFile memory;  // OpenImageIO's own memory streams do not hold files of several parts
  check_success(*out, out->open(memory.path(), int(specs.size()), specs.data()), "write", path);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i > 0)
      check_success(*out, out->open(memory.path(), specs[i], OIIO::ImageOutput::AppendSubimage), "write", path);
    check_success(*out, out->write_image(OIIO::TypeDesc::FLOAT, parts[i].image.pixels.data()), "write", path);
  }
  check_success(*out, out->close(), "write", path);
  check_whole(memory, specs, path);
  return memory.content();
}

}  // namespace meristem
