#include "geometry/io/polygon_mesh.h"

#include <fmt/format.h>

#include <algorithm>

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

std::optional<PolygonMesh::Conflict> PolygonMesh::first_conflict() const {
  struct Side {
    std::uint64_t edge;
    std::uint32_t face;
    auto operator<=>(const Side&) const = default;
  };
  std::vector<Side> sides;
  sides.reserve(corner_positions.size());
  for (std::uint32_t f = 0; f < face_count(); ++f)
    for (std::uint32_t c = face_starts[f]; c < face_starts[f + 1]; ++c) {
      const std::uint32_t next = c + 1 < face_starts[f + 1] ? c + 1 : face_starts[f];
      sides.push_back({std::uint64_t(corner_positions[c]) << 32 | corner_positions[next], f});
    }
  std::ranges::sort(sides);
  std::optional<Conflict> first;
  for (std::size_t i = 1; i < sides.size(); ++i)
    if (sides[i].edge == sides[i - 1].edge && (!first || sides[i].face < first->face))
      first =
          Conflict{sides[i].face, sides[i - 1].face, std::uint32_t(sides[i].edge >> 32), std::uint32_t(sides[i].edge)};
  return first;
}

}  // namespace meristem
