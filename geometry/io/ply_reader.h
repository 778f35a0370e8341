// Reads PLY, ASCII and binary in both byte orders: positions (x, y, z), texture coordinates of vertices (s, t; u, v;
// texture_u, texture_v) or of corners (the list "texcoord" of faces), colours of vertices (red, green, blue) and
// polygons (the list vertex_indices or vertex_index). All other elements and properties are passed over.
//
// Made for files of strangers: counts are compared with the file's size before anything is allocated, every index and
// number is checked, and errors point at the place, or for what is binary at the element's line in the header. The
// first error of the body ends it. Any thread; about 10 ns a binary number.
#pragma once

#include "geometry/base/source.h"
#include "geometry/io/polygon_mesh.h"

#include <memory>

namespace meristem {

// The mesh in the text; incomplete if diagnostics got an error.
PolygonMesh read_ply(const std::shared_ptr<const SourceText>& source, Diagnostics& diagnostics);

}  // namespace meristem
