// Scene files as text, and which files a scene may name.
//
// A scene may come from a stranger, so what it names (included files, images, meshes) is looked for in the scene's own
// folder alone. Errors go to the Diagnostics; nothing is thrown.
#pragma once

#include "geometry/base/source.h"

#include <filesystem>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>

namespace meristem {

// The text of a scene file, or of standard input if `path` is "-" (then named "<stdin>"). At most 64 MiB
// (JsoncLimits). A null pointer after an error.
std::shared_ptr<const SourceText> load_scene_text(const std::string& path, Diagnostics& diagnostics);

// The same for a stream.
std::shared_ptr<const SourceText> load_stream_text(std::istream& stream, std::string name, Diagnostics& diagnostics);

// The same for a file named in a scene at `where`: regular files only.
std::shared_ptr<const SourceText> load_named_text(const std::filesystem::path& file, std::string name,
                                                  const Location& where, Diagnostics& diagnostics);

// The file that `name` means when written at `where` in a file of the folder `from`: relative, without "..", and once
// all symbolic links are followed still inside `scene_folder` (canonical). Regular files only.
std::optional<std::filesystem::path> resolve_inside(const std::filesystem::path& scene_folder,
                                                    const std::filesystem::path& from, const std::string& name,
                                                    const Location& where, Diagnostics& diagnostics);

}  // namespace meristem
