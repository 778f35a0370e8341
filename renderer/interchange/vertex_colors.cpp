#include "renderer/interchange/vertex_colors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace meristem {

namespace {

// The direction in which the points spread most, at right angles to `aside`, a unit vector or zero: by power iteration,
// of which twice as many steps would change nothing that is seen.
Vec3d widest_direction(std::span<const Vec3d> points, Vec3d aside) {
  Vec3d rows[3];  // of the covariance
  for (const Vec3d& p : points)
    for (int k = 0; k < 3; ++k) rows[k] += p * p[k];
  const auto beside = [&](Vec3d v) { return v - aside * dot(v, aside); };
  // From the axis that spreads most
  Vec3d direction;
  for (int k = 0; k < 3; ++k) {
    Vec3d axis;
    axis[k] = 1;
    const Vec3d spread =
        beside(Vec3d{dot(rows[0], beside(axis)), dot(rows[1], beside(axis)), dot(rows[2], beside(axis))});
    if (length_squared(spread) > length_squared(direction)) direction = spread;
  }
  constexpr int steps = 200;
  for (int i = 0; i < steps && length_squared(direction) > 0; ++i) {
    direction = normalize(direction);
    direction = beside({dot(rows[0], direction), dot(rows[1], direction), dot(rows[2], direction)});
  }
  return length_squared(direction) > 0 ? normalize(direction) : Vec3d{};
}

}  // namespace

ColorPlane nearest_plane(std::span<const Vec3f> colors) {
  ColorPlane plane;
  Vec3d mean;
  for (const Vec3f c : colors) mean += Vec3d(c) / double(colors.size());
  std::vector<Vec3d> points;
  for (const Vec3f c : colors) points.push_back(Vec3d(c) - mean);
  const Vec3d first = widest_direction(points, {}), second = widest_direction(points, first);
  plane.uv.resize(colors.size());
  plane.corner = mean;
  // Calls set(i, coordinate) for all points; returns the way from 0 to 1
  const auto measure = [&](Vec3d direction, const auto& set) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vec3d& p : points) low = std::min(low, dot(p, direction)), high = std::max(high, dot(p, direction));
    constexpr double least = 1e-3;  // a quarter of a step of 8 bits: less is rounding
    if (!(high - low > least)) return Vec3d{};
    for (std::size_t i = 0; i < points.size(); ++i) set(i, (dot(points[i], direction) - low) / (high - low));
    plane.corner += direction * low;
    return direction * (high - low);
  };
  plane.along_u = measure(first, [&](std::size_t i, double x) { plane.uv[i].x = x; });
  plane.along_v = measure(second, [&](std::size_t i, double x) { plane.uv[i].y = x; });
  plane.distance.resize(colors.size());
  plane.aside = measure(cross(first, second), [&](std::size_t i, double x) { plane.distance[i] = x; });
  return plane;
}

DistancesOfFaces name_faces_by_distance(PolygonMesh& mesh, const ColorPlane& plane) {
  constexpr int levels = 64;
  constexpr std::uint32_t unused = PolygonMesh::none;
  std::vector<std::uint32_t> names(levels, unused);
  DistancesOfFaces result;
  mesh.names.clear();
  double squares = 0;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const std::uint32_t begin = mesh.face_starts[f], end = mesh.face_starts[f + 1];
    double middle = 0;
    for (std::uint32_t c = begin; c < end; ++c) middle += plane.distance[mesh.corner_uv[c]] / double(end - begin);
    const int level = int(std::lround(std::clamp(middle, 0.0, 1.0) * (levels - 1)));
    const double distance = double(level) / (levels - 1);
    std::uint32_t& name = names[std::size_t(level)];
    if (name == unused) {
      name = std::uint32_t(mesh.names.size());
      mesh.names.push_back("color" + std::to_string(level));
      result.by_name.push_back(distance);
    }
    mesh.face_names[f] = name;
    for (std::uint32_t c = begin; c < end; ++c) {
      const double off = plane.distance[mesh.corner_uv[c]] - distance;
      squares += off * off;
    }
  }
  result.error = length(plane.aside) * std::sqrt(squares / double(std::max<std::size_t>(mesh.corner_uv.size(), 1)));
  return result;
}

std::string color_text(Vec3d c) { return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", c.x, c.y, c.z); }

ColorsByUv color_by_uv(PolygonMesh& mesh, const ColorPlane& plane, const Location& where, Diagnostics& diagnostics) {
  ColorsByUv colors{color_text(plane.corner), {}};
  if (plane.along_u != Vec3d{}) colors.expression += " + u*" + color_text(plane.along_u);
  if (plane.along_v != Vec3d{}) colors.expression += " + v*" + color_text(plane.along_v);
  if (plane.aside == Vec3d{}) return colors;
  colors.expression += " + p0*" + color_text(plane.aside);
  const DistancesOfFaces distances = name_faces_by_distance(mesh, plane);
  for (std::size_t i = 0; i < distances.by_name.size(); ++i)
    colors.symbols.emplace_back(mesh.names[i], fmt::format("color({:.6g})", distances.by_name[i]));
  constexpr double seen = 0.02;
  if (distances.error > seen)
    diagnostics.warning(where,
                        fmt::format("colours of vertices were simplified by face; they are off by {:.2g} in the mean",
                                    distances.error));
  return colors;
}

}  // namespace meristem
