// What a scene consists of: the texts it was read from, and the files beside it that it names (meshes, images,
// volumes). So that it can be told whether a scene is still the same. Pure but for looking whether files are there.
#pragma once

#include "geometry/base/value.h"

#include <string>
#include <utility>
#include <vector>

namespace meristem {

// Name and SHA-256 of the scene's text, called "scene", and of the included ones, by their names without folders: the
// same wherever the scene lies.
std::vector<std::pair<std::string, std::string>> scene_texts(const Value& scene);

// The regular files in `folder` and below that some text value of the scene names: name as written and path, sorted by
// name, each once.
std::vector<std::pair<std::string, std::string>> named_files(const Value& scene, const std::string& folder);

}  // namespace meristem
