#include "geometry/io/mesh_file.h"

#include "geometry/io/obj_reader.h"
#include "geometry/io/ply_reader.h"
#include "geometry/io/whole_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

namespace meristem {

PolygonMesh load_mesh(const std::string& path, const Location& where, Diagnostics& diagnostics) {
  const auto fail = [&](std::string message) {
    diagnostics.error(where, std::move(message));
    return PolygonMesh{};
  };
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = 'A' <= c && c <= 'Z' ? char(c - 'A' + 'a') : c;
  if (extension != ".obj" && extension != ".ply")
    return fail(fmt::format("\"{}\" is no mesh file: these end in .obj or .ply", path));
  std::string reason;
  std::optional<std::string> text = read_whole_file(path, reason);  // fewer than 2^30 corners: 32 bits count them
  if (!text) return fail(std::move(reason));
  const auto source = std::make_shared<SourceText>(SourceText{path, std::move(*text)});
  return extension == ".obj" ? read_obj(source, diagnostics) : read_ply(source, diagnostics);
}

}  // namespace meristem
