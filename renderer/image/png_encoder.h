// PNG files, by libpng: OpenImageIO's libraries would take 125 MB and half a second (image_codec.h).
#pragma once

#include "renderer/image/image.h"

#include <string>

namespace meristem {

// The bytes of a PNG of the image's first three channels, or its only one, as display values clamped to [0, 1] (what is
// no number is 0) in steps (quantizer.h). It says that they are sRGB; "DateTime" becomes its time, all else of the
// metadata its text. Any thread; what fails is a FileError that names `path`.
std::string encode_png(const std::string& path, const Image& image, const Metadata& metadata,
                       const WriteOptions& options);

}  // namespace meristem
