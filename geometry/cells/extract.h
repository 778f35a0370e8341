// Cutting meshes into cells: a part of a mesh as a mesh of its own.
#pragma once

#include "geometry/mesh/mesh.h"

#include <span>

namespace meristem {

// The listed faces, in this order, with the vertices they use (in order of first use) and all attributes.
// Origins are kept in use order too. Linear in the faces listed plus one table over the mesh's vertices.
Mesh extract_faces(const Mesh& mesh, std::span<const std::uint32_t> faces);

}  // namespace meristem
