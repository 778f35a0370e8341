// Reads Wavefront OBJ: positions (v), texture coordinates (vt) and polygon faces (f), with the face's name from the
// statements before it: its group (g), or where there is none its material (usemtl). Indices may be negative; lines may
// go on behind a backslash. Everything else (normals, smoothing, objects, lines, points, libraries) is passed over.
//
// Made for files of strangers: every index is checked, memory is proportional to the file's size, and errors point at
// the line; after max_errors of them the rest is not read. Any thread; about 50 ns a number.
#pragma once

#include "geometry/base/source.h"
#include "geometry/base/vec.h"

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace meristem {

struct ObjMesh {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  std::vector<Vec3d> positions;
  std::vector<Vec2d> uv;
  std::vector<std::uint32_t> face_starts{0};    // corners of face f: [face_starts[f], face_starts[f + 1])
  std::vector<std::uint32_t> corner_positions;  // indices into positions
  std::vector<std::uint32_t> corner_uv;         // indices into uv, or none
  std::vector<std::uint32_t> face_names;        // one a face: an index into names
  std::vector<std::string> names;               // in the order in which faces use them; "" for a face without a name

  std::uint32_t face_count() const { return std::uint32_t(face_names.size()); }
};

// The mesh in the text; incomplete if diagnostics got an error.
ObjMesh read_obj(const std::shared_ptr<const SourceText>& source, Diagnostics& diagnostics);

// Reads a file of at most 1 GiB; errors about the file itself point to `where`.
ObjMesh load_obj(const std::string& path, const Location& where, Diagnostics& diagnostics);

}  // namespace meristem
