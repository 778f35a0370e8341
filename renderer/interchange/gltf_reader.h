// Reads glTF 2.0 (.gltf with files beside it, .glb): meshes, the tree of nodes, instances (EXT_mesh_gpu_instancing),
// perspective cameras, materials with their textures, lights (KHR_lights_punctual). Everything that was left out or
// became something else is a warning. One thread.
#pragma once

#include "renderer/interchange/foreign_scene.h"

#include <string>

namespace meristem {

// Files that it names lie in the folder of `path` or below it. Images go to the assets. Throws SceneErrors.
ForeignScene read_gltf(const std::string& path, AssetFolder& assets, Diagnostics& diagnostics);

}  // namespace meristem
