// Files that a scene names: images, volumes. They stand in the folder of the scene file that names them, or below it.
#pragma once

#include "geometry/base/params.h"

#include <optional>
#include <string>

namespace meristem {

// The path of `file`, the value of parameter `name`, as seen from the working directory. None, with an error at the
// parameter, if it leaves the folder of its scene file, be it by an absolute path, by ".." or by a symbolic link.
// Whether there is such a file is not asked.
std::optional<std::string> asset_path(Params& params, const char* name, const std::string& file);

// The path of `file` below `folder` (empty: the working directory) as seen from the working directory; none if it
// leaves it.
std::optional<std::string> path_in_folder(const std::string& folder, const std::string& file);

}  // namespace meristem
