// `meristem convert`: a scene of another program becomes a scene file.
#pragma once

#include <string>

namespace meristem {

struct ConvertOptions {
  std::string input;   // .pbrt, .gltf, .glb, .obj or .ply
  std::string output;  // .jsonc
  bool quiet = false;
};

int convert_command(const ConvertOptions& options);

}  // namespace meristem
