#include "renderer/image/texture.h"

#include "renderer/image/image_codec.h"

namespace meristem {

std::unique_ptr<const Texture> open_texture(const std::string& path, const TextureOptions& options) {
  return image_codec().open_texture(path, options);
}

}  // namespace meristem
