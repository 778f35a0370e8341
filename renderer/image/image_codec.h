// ImageCodec: what needs OpenImageIO, behind a module that is opened at first use.
//
// OpenImageIO brings some 250 shared libraries: half a second for the dynamic linker, and 125 MB of memory. So
// renderer/image/codec is not part of the program but of meristem_image.so (geometry/base/module.h), which is opened
// when the first image is read, or written as JPEG or TIFF.
#pragma once

#include "renderer/image/image.h"
#include "renderer/image/texture.h"

#include <memory>
#include <string>
#include <vector>

namespace meristem {

// Any thread; errors are FileErrors that name the file.
class ImageCodec {
 public:
  // `part` of a file with several, by name; empty: the first.
  virtual Image read(const std::string& path, const std::string& part) const = 0;
  // The bytes of a JPEG or TIFF file. `path` is for messages; the image's channels are those that the file gets.
  virtual std::vector<unsigned char> encode(const std::string& path, ImageFormat format, const Image& image,
                                            const Metadata& metadata, const WriteOptions& options) const = 0;
  virtual std::unique_ptr<const Texture> open_texture(const std::string& path, const TextureOptions& options) const = 0;
  // See renderer/image/texture.h.
  virtual std::vector<std::string> texture_faults() const = 0;

 protected:
  ~ImageCodec() = default;
};

// Opens the module at the first call; it stays open. Any thread; throws a FileError that names the module.
const ImageCodec& image_codec();

}  // namespace meristem

// What the module exports. Never null; lives as long as the module.
extern "C" const meristem::ImageCodec* meristem_image_codec();
