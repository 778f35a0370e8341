// Meshes of other programs as base meshes: manifolds whose smooth parts share vertices. What other formats split for
// texture coordinates is welded, and its corners keep them; what they smooth by normals shares vertices, and what is no
// manifold is cut until it is. Pure functions.
#pragma once

#include "geometry/base/source.h"
#include "geometry/io/polygon_mesh.h"

#include <optional>
#include <vector>

namespace meristem {

// Polygons over vertices that each have all attributes. Indices must hold.
struct ForeignMesh {
  std::vector<Vec3d> positions;
  std::vector<Vec3f> normals;  // empty: every face is flat
  std::vector<Vec2d> uv;       // empty, or one a vertex
  std::vector<std::uint32_t> face_starts{0}, corners;

  void add_face(std::initializer_list<std::uint32_t> vertices);
};

struct MeshRepairs {
  std::size_t degenerate = 0;  // faces left out, for they had less than three corners or no area
  std::size_t cut = 0;         // vertices added since too many faces met in an edge or a point

  // Warns of what was done.
  void report(const Location& where, Diagnostics& diagnostics) const;
};

// Vertices with one position and normal become one; without normals every face has its own. Normals themselves are not
// kept: they are made anew from the faces.
PolygonMesh to_polygon_mesh(const ForeignMesh& mesh, MeshRepairs& repairs);

// Gives vertices of their own to faces that meet others in a way that no manifold has; returns how many were added.
std::size_t cut_to_manifold(PolygonMesh& mesh);

}  // namespace meristem
