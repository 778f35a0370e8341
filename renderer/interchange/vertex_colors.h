// Colours of vertices in what base meshes carry: two numbers a vertex, u and v, which are straight across faces as
// colours are, and parameters a face. u and v name a place on the plane that lies nearest to all colours; the distance
// from it is kept by face. Pure functions.
#pragma once

#include "geometry/base/source.h"
#include "geometry/io/polygon_mesh.h"

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace meristem {

// Colours are corner + u * along_u + v * along_v + distance * aside. Mixtures of three colours lie on a plane, greys on
// a line: what does not vary is zero.
struct ColorPlane {
  Vec3d corner, along_u, along_v, aside;
  std::vector<Vec2d> uv;         // of each colour, in [0, 1]
  std::vector<double> distance;  // likewise
};

ColorPlane nearest_plane(std::span<const Vec3f> colors);

// Gives faces names by the mean distance of their corners, rounded to one of 64; `corner_uv` of the mesh are indices of
// colours. `error`: the root of the mean square of what colours at corners are off by.
struct DistancesOfFaces {
  std::vector<double> by_name;
  double error = 0;
};
DistancesOfFaces name_faces_by_distance(PolygonMesh& mesh, const ColorPlane& plane);

// How a material and the symbols of faces say them: an expression over u, v and p0, and symbols by the names of faces.
struct ColorsByUv {
  std::string expression;
  std::vector<std::pair<std::string, std::string>> symbols;
};
// Of a mesh as above, whose faces may get other names. Warns at `where` if colours are off by what is seen.
ColorsByUv color_by_uv(PolygonMesh& mesh, const ColorPlane& plane, const Location& where, Diagnostics& diagnostics);

std::string color_text(Vec3d color);

}  // namespace meristem
