#include "geometry/io/polygon_mesh.h"

#include <fmt/format.h>

namespace meristem {

namespace {

constexpr std::size_t max_face_corners = 1000;  // repeated vertices are looked for in quadratic time

}  // namespace

std::string PolygonMesh::face_defect(std::size_t first) const {
  const std::size_t count = corner_positions.size() - first;
  if (count < 3) return fmt::format("a face needs at least 3 corners, found {}", count);
  if (count > max_face_corners)
    return fmt::format("a face has {} corners; at most {} are read", count, max_face_corners);
  for (std::size_t i = first; i < first + count; ++i)
    for (std::size_t j = i + 1; j < first + count; ++j)
      if (corner_positions[i] == corner_positions[j])
        return fmt::format("a face has vertex {} twice", corner_positions[i] + 1);
  return {};
}

}  // namespace meristem
