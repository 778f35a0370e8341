// Tessellation: the final surface of a leaf cell as float arrays, ready for intersection: grids where subdivision left
// regular squares of quads, triangles elsewhere. Immutable; any thread may read.
#pragma once

#include "geometry/cells/model.h"
#include "geometry/cells/packing.h"
#include "geometry/cells/uv_readers.h"
#include "geometry/mesh/face_origins.h"
#include "geometry/mesh/limit.h"

#include <array>
#include <optional>
#include <vector>

namespace meristem {

// How a surface is made of its vertices.
struct SurfaceFaces {
  // width x height vertices, row by row, with its own vertices from first_vertex on; all faces of a grid have one
  // origin.
  struct Grid {
    std::uint32_t first_vertex;
    std::uint16_t width, height;
    std::uint32_t origin;
    std::uint32_t leaf;
    int coarser = 0;  // by so many refinements than the leaf's other faces may be
  };
  struct TriangleSource {
    std::uint32_t origin;
    std::uint32_t leaf;
  };
  // What faces share that were done at one level, and whose u, v fit into one frame; there are several where that was
  // not so, or parts of a cell, or many cells, were put together.
  struct Leaf {
    UvFrame uv_frame;
    int level = 0;  // steps of the model that were done
  };

  std::vector<Grid> grids;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<TriangleSource> triangle_sources;
  std::vector<Leaf> leaves;
  FaceOrigins origins;
  std::uint64_t face_count = 0;  // owned faces of the final mesh, before polygons were cut into triangles

  std::size_t bytes() const;  // beside itself
};

struct Tessellation : SurfaceFaces {
  std::vector<Vec3f> positions;
  std::vector<PackedAttributes> attributes;  // of the vertices; normals outwards
  bool has_uv = true;                        // else those of the attributes mean nothing

  Bounds3f bounds() const;
};

// Calls visit(corners, origin) for every triangle. Quads of grids are cut along the diagonal from the second
// corner to the third.
template <class Visit>
void for_each_triangle(const Tessellation& t, const Visit& visit) {
  for (std::size_t i = 0; i < t.triangles.size(); ++i) visit(t.triangles[i], t.triangle_sources[i].origin);
  for (const Tessellation::Grid& grid : t.grids)
    for (std::uint32_t y = 0; y + 1 < grid.height; ++y)
      for (std::uint32_t x = 0; x + 1 < grid.width; ++x) {
        const std::uint32_t a = grid.first_vertex + y * grid.width + x, b = a + 1, c = a + grid.width, d = c + 1;
        visit(std::array{a, b, c}, grid.origin);
        visit(std::array{b, d, c}, grid.origin);
      }
}

// Where the vertices of a mesh lie that is shown as it is, and their normals: with `smoothing` on the limit surface of
// that scheme (a mesh that it has not made yet is refined once for that), without, the mesh's own and the means of its
// face normals.
LimitSurface shown_surface(const CellMesh& cell, const std::optional<Smoothing>& smoothing);

// How owned faces stand in squares: `corners` holds the corner counts of the faces from which the last `refinements`
// Catmull-Clark steps made them (each quad a square of 4^refinements faces, each n-gon n squares of
// 4^(refinements - 1)). Without refinements every face stands for itself.
struct Squares {
  std::vector<std::uint32_t> corners;
  int refinements = 0;

  // What has come of one face.
  std::uint32_t faces_of(std::uint32_t face_corners) const {
    if (refinements < 1) return 1;
    return face_corners == 4 ? 1u << (2 * refinements) : face_corners << (2 * (refinements - 1));
  }
};

// Faces that were done before the rest of their cell, after `level` steps: all their vertices are frozen.
struct DoneFaces {
  Mesh mesh;
  int level = 0;
  Squares squares;
};

// Of the final mesh of a cell after `level` steps, with one ring of halo, and of what was done before. Positions and
// normals are those of shown_surface(), frozen vertices are shown where they were frozen, others faded in (fading.h);
// squares in which the last refinements made nothing but copies become coarser grids. The triangles that have an area
// are the same however many of the refinements have been made of faces that were done before: how a model is cut into
// cells does not show. Positions are rounded (position_lattice.h), u, v as well (uv_lattice.h); these are left out if
// no material of the faces reads them.
Tessellation tessellate(const Model& model, const CellMesh& cell, int level, const Squares& squares,
                        std::span<const DoneFaces> done = {}, const UvReaders& uv_readers = {});

}  // namespace meristem
