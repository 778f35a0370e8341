// Reads the scenes of pbrt-v4, so far as this renderer has the same things: transforms, instances, meshes, spheres and
// disks, perspective cameras, common materials, image textures, lights. Everything that was left out or became
// something else is a warning at its place. One thread.
#pragma once

#include "renderer/interchange/foreign_scene.h"

#include <string>

namespace meristem {

// Files that the scene names lie in the folder of `path` or below it. Images are copied to the assets. Throws
// SceneErrors.
ForeignScene read_pbrt(const std::string& path, AssetFolder& assets, Diagnostics& diagnostics);

}  // namespace meristem
