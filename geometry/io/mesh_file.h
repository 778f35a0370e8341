// Mesh files by their extension: OBJ (obj_reader.h) and PLY (ply_reader.h). Any thread.
#pragma once

#include "geometry/base/source.h"
#include "geometry/io/polygon_mesh.h"

#include <string>

namespace meristem {

// Reads a file of at most 1 GiB. Errors in it point into it, errors about the file itself to `where`; the mesh is
// incomplete if there was one.
PolygonMesh load_mesh(const std::string& path, const Location& where, Diagnostics& diagnostics);

}  // namespace meristem
