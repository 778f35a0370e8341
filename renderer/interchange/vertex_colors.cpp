#include "renderer/interchange/vertex_colors.h"

#include "geometry/base/check.h"

#include <cmath>

namespace meristem {

Image patches_of_colors(PolygonMesh& mesh, std::span<const Vec3f> colors) {
  const std::uint32_t count = mesh.face_count();
  const std::uint32_t columns = std::max(1u, std::uint32_t(std::ceil(std::sqrt(double(count)))));
  const std::uint32_t rows = std::max(1u, (count + columns - 1) / columns);
  Image image{int(2 * columns), int(2 * rows), 3, {}};
  image.pixels.resize(std::size_t(image.width) * std::size_t(image.height) * 3);
  mesh.uv.clear();
  for (std::uint32_t f = 0; f < count; ++f) {
    const std::size_t first = mesh.face_starts[f];
    CHECK(mesh.face_starts[f + 1] == first + 3, "face {} is no triangle", f);
    const auto color = [&](std::size_t corner) { return colors[mesh.corner_uv[first + corner]]; };
    // The fourth is where it lies on the plane through the other three
    const Vec3f texels[4] = {color(0), color(1), color(2), color(1) + color(2) - color(0)};
    for (std::uint32_t t = 0; t < 4; ++t) {
      const std::uint32_t x = 2 * (f % columns) + t % 2, y = 2 * (f / columns) + t / 2;
      for (int k = 0; k < 3; ++k)
        image.pixels[(std::size_t(y) * std::size_t(image.width) + x) * 3 + std::size_t(k)] = texels[t][k];
      if (t == 3) continue;
      mesh.uv.push_back({(x + 0.5) / image.width, 1 - (y + 0.5) / image.height});
      mesh.corner_uv[first + t] = std::uint32_t(mesh.uv.size()) - 1;
    }
  }
  return image;
}

}  // namespace meristem
