// What is known of a part of a mesh before a step, as bounds analysis starts from it.
#pragma once

#include "geometry/cells/model.h"
#include "geometry/mesh/adjacency.h"

#include <span>

namespace meristem {

// How often bounds are told again from the footprints in the bounds so far, where these say how large things become.
constexpr int footprint_passes = 6;

// The extent of the listed faces before step `level`; the mesh must hold two complete rings around them.
Extent region_extent(const Model& model, const Mesh& mesh, const Adjacency& adjacency,
                     std::span<const std::uint32_t> faces, int level);

// Final bounds of everything that comes of the listed owned faces of a cell before step `level`: by that extent, but
// for what steps can derive (Step::derive), so many levels of it.
Bounds3d region_bounds(const Model& model, const CellMesh& cell, const Adjacency& adjacency,
                       std::span<const std::uint32_t> faces, int level, int derived_levels);

}  // namespace meristem
