// Materials of a glTF file as openpbr, their images as files.
#pragma once

#include "renderer/interchange/foreign_scene.h"
#include "renderer/interchange/gltf_buffers.h"

#include <map>

namespace meristem {

class GltfMaterials {
 public:
  GltfMaterials(GltfBuffers& buffers, AssetFolder& assets, Diagnostics& diagnostics)
      : buffers_(buffers), assets_(assets), diagnostics_(diagnostics) {}
  // As a scene file has it.
  Value material(const Value& gltf);

 private:
  // The name by which expressions read a texture, which is added to `material`; empty if it cannot be read.
  std::string texture(const Value* info, const char* name, const char* color_space, Value& material);
  std::string image_file(const Value& image);

  GltfBuffers& buffers_;
  AssetFolder& assets_;
  Diagnostics& diagnostics_;
  std::map<const Value*, std::string> files_;
};

}  // namespace meristem
