// A scene file with all it includes, as one Value.
//
//   "include": "library.jsonc"      or a list of names
//
// at the top of a scene takes over the members of the sections "materials" and "models" of other files of the scene's
// folder. An included file may hold "format", "include", "materials" and "models", nothing else; names are relative to
// the file they stand in. What is included stands before what the file defines itself; a name defined twice is an
// error. A file included by two others is read once; one that includes itself, through whichever others, is an error.
#pragma once

#include "geometry/base/value.h"

#include <string>

namespace meristem {

// The one version of the language there is: the member "format" of a file, if it is written, must say it.
constexpr int scene_format = 1;

struct IncludeLimits {
  static constexpr int depth = 16;   // of files including files
  static constexpr int files = 256;  // in one scene
};

// Reads the scene file `path` ("-": standard input, which cannot include) and merges what it includes; the member
// "include" itself is left out. Call diagnostics.throw_if_errors() before looking at the result: after an error it is
// incomplete.
Value read_scene_file(const std::string& path, Diagnostics& diagnostics);

}  // namespace meristem
