#include "geometry/io/mesh_file.h"

#include "geometry/io/obj_reader.h"
#include "geometry/io/ply_reader.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <system_error>

namespace meristem {

namespace {

constexpr std::uintmax_t max_file_bytes = std::uintmax_t(1)
                                          << 30;  // fewer than 2^30 vertices and corners: 32 bits count them

}  // namespace

PolygonMesh load_mesh(const std::string& path, const Location& where, Diagnostics& diagnostics) {
  const auto fail = [&](std::string message) {
    diagnostics.error(where, std::move(message));
    return PolygonMesh{};
  };
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension != ".obj" && extension != ".ply")
    return fail(fmt::format("\"{}\" is no mesh file: these end in .obj or .ply", path));
  std::error_code code;
  const std::uintmax_t bytes = std::filesystem::file_size(path, code);
  if (code) return fail(fmt::format("cannot read \"{}\": {}", path, code.message()));
  if (bytes > max_file_bytes)
    return fail(fmt::format("\"{}\" has {} bytes; at most {} are read", path, bytes, max_file_bytes));
  auto source = std::make_shared<SourceText>(SourceText{path, std::string(std::size_t(bytes), '\0')});
  std::ifstream file(path, std::ios::binary);
  if (!file.read(source->text.data(), std::streamsize(bytes))) return fail(fmt::format("cannot read \"{}\"", path));
  return extension == ".obj" ? read_obj(source, diagnostics) : read_ply(source, diagnostics);
}

}  // namespace meristem
