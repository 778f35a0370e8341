// Reads Wavefront OBJ: positions (v; colours behind them), texture coordinates (vt) and polygon faces (f), with the
// face's name from the statements before it: its group (g), or where there is none its material (usemtl). Indices may
// be negative; lines may go on behind a backslash. Everything else (normals, smoothing, objects, lines, points,
// libraries) is passed over.
//
// Made for files of strangers: every index is checked, memory is proportional to the file's size, and errors point at
// the line; after max_errors of them the rest is not read. Any thread; about 50 ns a number.
#pragma once

#include "geometry/base/source.h"
#include "geometry/io/polygon_mesh.h"

#include <memory>

namespace meristem {

// The mesh in the text; incomplete if diagnostics got an error.
PolygonMesh read_obj(const std::shared_ptr<const SourceText>& source, Diagnostics& diagnostics);

}  // namespace meristem
