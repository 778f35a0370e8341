// SurfaceWelder: the cells of one surface as one mesh. Vertices that cells or grids share have the same bits in each
// (docs/architecture.md, section 4), so they are recognised by their positions, and normals that roughly agree: two
// sheets back to back stay two, and where level of detail shows vertices at others these are one. So the mesh of a
// closed model is closed, but for the seams of its textures, at whose vertices u, v differ. Remembers only the vertices
// on borders of cells, some eighth of all. One thread.
#pragma once

#include "geometry/cells/tessellation.h"

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace meristem {

class SurfaceWelder {
 public:
  struct Triangle {
    std::array<std::uint32_t, 3> vertices;  // of the surface
    std::uint32_t origin;                   // of the cell
  };
  // What a cell adds to the surface.
  struct Piece {
    std::uint32_t first_vertex = 0;            // the number of the first new one
    std::vector<std::uint32_t> cell_vertices;  // of each new one: the cell's vertex that it is
    std::vector<Triangle> triangles;           // without those that welding makes lines or points
  };

  Piece add(const Tessellation& cell);

 private:
  // Numbers of vertices by where they are.
  class Vertices {
   public:
    // That of a vertex that is known, else `number`, which is known from then on.
    std::uint32_t find_or_add(Vec3f position, PackedNormal normal, Vec2f uv, std::uint32_t number);

   private:
    struct Hash {
      std::size_t operator()(Vec3f p) const;
    };
    struct Vertex {
      PackedNormal normal;
      Vec2f uv;
      std::uint32_t number;
    };
    std::unordered_multimap<Vec3f, Vertex, Hash> vertices_;
  };

  Vertices border_;  // of the cells so far: numbers in the surface
  std::uint32_t vertices_ = 0;
};

}  // namespace meristem
