// PolygonMesh: what a mesh file holds. Plain data.
#pragma once

#include "geometry/base/source.h"
#include "geometry/base/vec.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace meristem {

struct PolygonMesh {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  // Of coordinates of all kinds, in readers: no model reaches further.
  static constexpr double largest_coordinate = 1e15;

  std::vector<Vec3d> positions;
  std::vector<Vec3f> colors;  // empty, or one a position: linear
  std::vector<Vec2d> uv;
  std::vector<std::uint32_t> face_starts{0};    // corners of face f: [face_starts[f], face_starts[f + 1])
  std::vector<std::uint32_t> corner_positions;  // indices into positions
  std::vector<std::uint32_t> corner_uv;         // indices into uv, or none
  std::vector<std::uint32_t> face_names;        // one a face: an index into names
  std::vector<std::string> names;               // in the order in which faces use them; "" for a face without a name

  // Where faces stand in the file's text; empty if it is not known.
  std::shared_ptr<const SourceText> text;
  std::vector<std::uint32_t> face_places;

  std::uint32_t face_count() const { return std::uint32_t(face_names.size()); }

  // What is wrong with the corners from `first` on as one face, or an empty text.
  std::string face_defect(std::size_t first) const;

  // A face that passes an edge in the direction in which one before it does, which no manifold has.
  struct Conflict {
    std::uint32_t face, earlier_face;
    std::uint32_t from, to;  // the edge: positions
  };
  std::optional<Conflict> first_conflict() const;
};

}  // namespace meristem
