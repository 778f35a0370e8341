// Tessellation: the final surface of a leaf cell as float arrays, ready for intersection: grids where subdivision left
// regular squares of quads, triangles elsewhere. Immutable; any thread may read.
#pragma once

#include "geometry/cells/model.h"

#include <array>
#include <optional>
#include <vector>

namespace meristem {

struct Tessellation {
  // width x height vertices, row by row, with its own vertices from first_vertex on; all faces of a grid have one
  // origin.
  struct Grid {
    std::uint32_t first_vertex;
    std::uint16_t width, height;
    std::uint32_t origin;
  };

  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;  // unit, outwards
  std::vector<Vec2f> uv;
  std::vector<Grid> grids;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> triangle_origins;
  std::vector<FaceOrigin> origins;
  std::uint64_t face_count = 0;  // owned faces of the final mesh, before polygons were cut into triangles

  std::size_t bytes() const;
  Bounds3f bounds() const;
};

// Of the final mesh of a cell with one ring of halo. `root_corners` holds the corner counts of the owned faces from
// which the last `refinements` Catmull-Clark steps made the mesh (each quad a square of 4^refinements faces, each n-gon
// n squares of 4^(refinements - 1)). With `smoothing`, the scheme of a model that ends in plain smoothing, positions
// and normals are those of its limit surface; without, the mesh's own and the means of its face normals.
Tessellation tessellate(const CellMesh& cell, std::span<const std::uint32_t> root_corners, int refinements,
                        const std::optional<RefineOptions>& smoothing);

}  // namespace meristem
