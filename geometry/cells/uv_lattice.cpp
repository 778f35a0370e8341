#include "geometry/cells/uv_lattice.h"

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

// Of the face with these corners, from `uv` by vertex, into those of its vertices.
template <class Corners>
void widen(const Corners& corners, const Vec2d* uv, Vec2f* widths) {
  __m128d low = _mm_loadu_pd(&uv[corners[0]].x), high = low;
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const __m128d at = _mm_loadu_pd(&uv[corners[i]].x);
    low = _mm_min_pd(low, at);
    high = _mm_max_pd(high, at);
  }
  const __m128 width = _mm_cvtpd_ps(_mm_sub_pd(high, low));
  for (const std::uint32_t v : corners) store_uv(widths[v], _mm_max_ps(width, load_uv(widths[v])));
}

// Where growth left u, v at corners: of each face its own, and how far a vertex lies from these.
void widen_by_corners(const Mesh& mesh, std::span<const Vec2d> uv, Vec2f* widths) {
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    Vec2d low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
    for (std::uint32_t c = mesh.face_starts[f]; c < mesh.face_starts[f + 1]; ++c) {
      const Vec2d own = mesh.corner_uv[c];
      low = {std::min(low.x, own.x), std::min(low.y, own.y)};
      high = {std::max(high.x, own.x), std::max(high.y, own.y)};
    }
    for (std::uint32_t c = mesh.face_starts[f]; c < mesh.face_starts[f + 1]; ++c) {
      const std::uint32_t v = mesh.corner_vertices[c];
      const Vec2d own = mesh.corner_uv[c];
      const double u_width = std::max(high.x - low.x, 2 * std::abs(own.x - uv[v].x)),
                   v_width = std::max(high.y - low.y, 2 * std::abs(own.y - uv[v].y));
      widths[v] = {std::max(widths[v].x, float(u_width)), std::max(widths[v].y, float(v_width))};
    }
  }
}

}  // namespace

UvLattice::UvLattice(const Mesh& mesh, std::span<const Vec2d> uv) : widths_(mesh.vertex_count(), Vec2f{}) {
  // Not by the corners: those of a face beyond the cell's are not known once levels of detail differ
  for (std::uint32_t f = 0; f < mesh.seam_widths.size(); ++f)
    for (const std::uint32_t v : mesh.corners(f))
      store_uv(widths_[v], _mm_max_ps(load_uv(mesh.seam_widths[f]), load_uv(widths_[v])));
  if (mesh.uv.empty() && !mesh.corner_uv.empty()) widen_by_corners(mesh, uv, widths_.data());
  if (mesh.uv.empty() || !mesh.seam_widths.empty()) return;
  const std::uint32_t* const corners = mesh.corner_vertices.data();
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const std::uint32_t first = mesh.face_starts[f], count = mesh.face_starts[f + 1] - first;
    if (count == 4)
      widen(std::span<const std::uint32_t, 4>(corners + first, 4), uv.data(), widths_.data());
    else
      widen(std::span(corners + first, count), uv.data(), widths_.data());
  }
}

}  // namespace meristem
