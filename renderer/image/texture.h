// Texture: an image file that is asked for colours at texture coordinates, through OpenImageIO's texture system: tiles
// are read where they are first asked for, and those of all textures together take no more than 512 MiB.
//
// EXR, PNG, JPEG, Radiance HDR and TIFF, in the limits of read_image(). Bilinear between texels, at full resolution:
// samples of a pixel do the filtering. Colours are scene-linear: encoded texels are decoded before they are blended.
#pragma once

#include "geometry/base/vec.h"

#include <memory>
#include <string>

namespace meristem {

enum class TextureWrap { Repeat, Clamp, Mirror, Black };
enum class TextureEncoding { Auto, Srgb, Linear };  // Auto: sRGB for whole numbers, linear for floats

struct TextureOptions {
  TextureWrap wrap = TextureWrap::Repeat;
  TextureEncoding encoding = TextureEncoding::Auto;
};

class Texture {
 public:
  virtual ~Texture() = default;
  // u to the right, v up, the image in [0, 1]^2; grey three times if the file has no colour. Any thread. A tile that
  // cannot be read is black.
  virtual Vec3f at(Vec2f uv) const = 0;
};

// Throws a FileError if the file is missing or not such an image.
std::unique_ptr<const Texture> open_texture(const std::string& path, const TextureOptions& options);

}  // namespace meristem
