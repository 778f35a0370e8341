// Leaf shapes: small meshes, an open sheet each, that a tree puts out by the thousands.
//
// A shape lies in a frame of its own: y from the foot (0) to the tip (1), x across (-1/2 ... 1/2), z the upper side;
// halves are folded up a little along the midrib. A tree scales x by width and length of the leaf, y and z by its
// length. The foot is at the origin, on the axis of the stem that bears it. Immutable; any thread.
#pragma once

#include "geometry/base/vec.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace meristem {

struct LeafShape {
  std::vector<Vec3d> vertices;
  std::vector<Vec2d> uv;                   // u across, 0.5 on the midrib; v along; on the grid of u, v
  std::vector<std::uint32_t> face_starts;  // into corners; one more than faces
  std::vector<std::uint32_t> corners;      // counter-clockwise seen from above
  std::vector<Vec2d> corner_uv;            // the u, v of each
  double reach = 0;                        // of a vertex from the foot, for a leaf as wide as long
  double area = 0;                         // likewise, seen from above

  std::uint32_t face_count() const { return std::uint32_t(face_starts.size()) - 1; }
  std::span<const std::uint32_t> face(std::uint32_t f) const {
    return {corners.data() + face_starts[f], face_starts[f + 1] - face_starts[f]};
  }
};

const std::vector<std::string>& leaf_shape_names();
const LeafShape& leaf_shape(int index);
// One face of about the same area, for leaves that are no larger than a pixel.
const LeafShape& simple_leaf_shape(int index);

}  // namespace meristem
