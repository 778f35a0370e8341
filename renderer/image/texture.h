// Texture: an image file that is asked for colours at texture coordinates, through OpenImageIO's texture system: tiles
// are read where they are first asked for, and those of all textures together take no more than 512 MiB.
//
// EXR, PNG, JPEG, Radiance HDR and TIFF, in the limits of read_image(). A lookup is the mean over a footprint, by
// ellipses on a pyramid of coarser images (Heckbert 1989, "Fundamentals of Texture Mapping and Image Warping"), or
// bilinear between texels at a point. Colours are scene-linear: encoded texels are decoded before anything blends them.
// Alpha is left alone.
#pragma once

#include "geometry/base/vec.h"

#include <memory>
#include <string>
#include <vector>

namespace meristem {

enum class TextureWrap { Repeat, Clamp, Mirror, Black };
enum class TextureEncoding { Auto, Srgb, Linear };  // Auto: sRGB for whole numbers, linear for floats

struct TextureOptions {
  TextureWrap wrap = TextureWrap::Repeat;
  TextureEncoding encoding = TextureEncoding::Auto;
};

// The sides of the parallelogram around a point of the image that a lookup stands for, as steps in u, v. Both zero: the
// point alone.
struct TextureFootprint {
  Vec2f side_a, side_b;
};

class Texture {
 public:
  virtual ~Texture() = default;
  // u to the right, v up, the image in [0, 1]^2; grey three times if the file has no colour. Any thread. A tile that
  // cannot be read is black, and a fault.
  virtual Vec3f mean(Vec2f uv, const TextureFootprint& footprint) const = 0;
  Vec3f at(Vec2f uv) const { return mean(uv, {}); }
};

// Throws a FileError if the file is missing or not such an image.
std::unique_ptr<const Texture> open_texture(const std::string& path, const TextureOptions& options);

// Of all textures of this process: files of which a part could not be read when it was looked up, with the reason.
std::vector<std::string> texture_faults();

}  // namespace meristem
