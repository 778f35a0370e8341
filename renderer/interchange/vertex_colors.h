// Colours of vertices as u, v: base meshes carry no colours, but two numbers a vertex, which are straight across faces
// as colours are. They name a place on the plane that lies nearest to all colours. Pure functions.
#pragma once

#include "geometry/base/vec.h"

#include <span>
#include <vector>

namespace meristem {

// Colours are corner + u * along_u + v * along_v: exactly if they lie on a plane, as mixtures of three do, and greys.
struct ColorPlane {
  Vec3d corner, along_u, along_v;
  std::vector<Vec2d> uv;  // of each colour, in [0, 1]
  double error = 0;       // root of the mean square distance of colours from the plane
};

ColorPlane nearest_plane(std::span<const Vec3f> colors);

}  // namespace meristem
