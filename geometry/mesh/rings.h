// Rings of faces around a set of faces.
#pragma once

#include "geometry/mesh/mesh.h"

#include <cstdint>
#include <vector>

namespace meristem {

constexpr std::uint8_t unreached_ring = 255;

// The distance of every face from the first `owned_faces` by shared vertices (0 for these, 1 for faces that touch one,
// ...); unreached_ring beyond max_ring. Linear in the mesh for each ring.
std::vector<std::uint8_t> face_rings(const Mesh& mesh, std::uint32_t owned_faces, int max_ring);

// The same around any faces: `rings` is 0 at these and unreached_ring elsewhere, and is filled in.
void find_rings(const Mesh& mesh, std::vector<std::uint8_t>& rings, int max_ring);

}  // namespace meristem
