// Textures upon OpenImageIO's texture system.
#pragma once

#include "renderer/image/texture.h"

#include <memory>
#include <string>
#include <vector>

namespace meristem {

// `path` has been found to be an image that read_image() would read.
std::unique_ptr<const Texture> make_oiio_texture(const std::string& path, const TextureOptions& options);

std::vector<std::string> oiio_texture_faults();

}  // namespace meristem
