#include "renderer/image/texture.h"

#include "renderer/image/image_codec.h"

#include <atomic>

namespace meristem {

namespace {

std::atomic<bool> has_textures = false;  // else the module need not be opened to know that none has a fault

}  // namespace

std::unique_ptr<const Texture> open_texture(const std::string& path, const TextureOptions& options) {
  has_textures = true;
  return image_codec().open_texture(path, options);
}

std::vector<std::string> texture_faults() {
  return has_textures ? image_codec().texture_faults() : std::vector<std::string>{};
}

}  // namespace meristem
