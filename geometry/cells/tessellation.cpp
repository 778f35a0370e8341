#include "geometry/cells/tessellation.h"

#include "geometry/base/check.h"
#include "geometry/mesh/limit.h"
#include "geometry/mesh/refine.h"

namespace meristem {

namespace {

template <class T>
std::size_t capacity_bytes(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

// The mean of the unit normals of the faces that meet in a vertex.
std::vector<Vec3d> vertex_normals(const Mesh& mesh) {
  std::vector<Vec3d> sums(mesh.vertex_count());
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = mesh.corners(f);
    const Vec3d normal = unit_face_normal(mesh.positions, corners.data(), std::uint32_t(corners.size()));
    for (std::uint32_t v : corners) sums[v] += normal;
  }
  for (Vec3d& n : sums) n = normalize(n);
  return sums;
}

LimitSurface final_surface(const CellMesh& cell, const std::optional<RefineOptions>& smoothing) {
  if (smoothing) return limit_surface(cell.mesh, cell.owned_faces, *smoothing);
  return {cell.mesh.positions, vertex_normals(cell.mesh)};
}

class Tessellator {
 public:
  Tessellator(const CellMesh& cell, const std::optional<RefineOptions>& smoothing)
      : mesh_(cell.mesh), surface_(final_surface(cell, smoothing)), uv_(vertex_uv(cell.mesh)) {
    out_.origins = cell.mesh.origins;
    out_.face_count = cell.owned_faces;
  }

  // A square of 4^levels faces from `first` on: their order is that of a quadtree whose children run around the face.
  void add_grid(std::uint32_t first, int levels) {
    const std::uint32_t side = 1u << levels, width = side + 1;
    const std::uint32_t base = std::uint32_t(out_.positions.size());
    grid_vertices_.assign(std::size_t(width) * width, 0);
    for (std::uint32_t k = 0; k < side * side; ++k) {
      std::uint32_t i = 0, j = 0;
      for (int level = levels; level-- > 0;) {
        const std::uint32_t child = k >> (2 * level) & 3;
        i = i * 2 + (child == 1 || child == 2);
        j = j * 2 + (child >= 2);
      }
      const auto c = mesh_.corners(first + k);
      grid_vertices_[j * width + i] = c[0];
      grid_vertices_[j * width + i + 1] = c[1];
      grid_vertices_[(j + 1) * width + i + 1] = c[2];
      grid_vertices_[(j + 1) * width + i] = c[3];
    }
    for (std::uint32_t v : grid_vertices_) add_vertex(v);
    out_.grids.push_back({base, std::uint16_t(width), std::uint16_t(width), mesh_.face_origins[first]});
  }

  // Fans from the first corner; vertices are shared between faces.
  void add_polygon(std::uint32_t face) {
    const auto corners = mesh_.corners(face);
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
      out_.triangles.push_back({shared_vertex(corners[0]), shared_vertex(corners[i]), shared_vertex(corners[i + 1])});
      out_.triangle_origins.push_back(mesh_.face_origins[face]);
    }
  }

  Tessellation take() { return std::move(out_); }

 private:
  std::uint32_t add_vertex(std::uint32_t v) {
    out_.positions.push_back(Vec3f(surface_.positions[v]));
    out_.normals.push_back(Vec3f(surface_.normals[v]));
    out_.uv.push_back({float(uv_[v].x), float(uv_[v].y)});
    return std::uint32_t(out_.positions.size()) - 1;
  }
  std::uint32_t shared_vertex(std::uint32_t v) {
    constexpr std::uint32_t none = ~std::uint32_t(0);
    if (shared_.empty()) shared_.assign(mesh_.vertex_count(), none);
    if (shared_[v] == none) shared_[v] = add_vertex(v);
    return shared_[v];
  }

  const Mesh& mesh_;
  const LimitSurface surface_;
  const std::vector<Vec2d> uv_;
  std::vector<std::uint32_t> grid_vertices_, shared_;
  Tessellation out_;
};

}  // namespace

std::size_t Tessellation::bytes() const {
  return capacity_bytes(positions) + capacity_bytes(normals) + capacity_bytes(uv) + capacity_bytes(grids) +
         capacity_bytes(triangles) + capacity_bytes(triangle_origins) + capacity_bytes(origins);
}

Bounds3f Tessellation::bounds() const {
  Bounds3f b;
  for (Vec3f p : positions) b.extend(p);
  return b;
}

Tessellation tessellate(const CellMesh& cell, std::span<const std::uint32_t> root_corners, int refinements,
                        const std::optional<RefineOptions>& smoothing) {
  Tessellator tessellator(cell, smoothing);
  if (refinements < 1) {
    for (std::uint32_t f = 0; f < cell.owned_faces; ++f) tessellator.add_polygon(f);
    return tessellator.take();
  }
  std::uint32_t first = 0;
  for (std::uint32_t corners : root_corners) {
    const int levels = corners == 4 ? refinements : refinements - 1;
    const std::uint32_t squares = corners == 4 ? 1 : corners;
    for (std::uint32_t i = 0; i < squares; ++i, first += 1u << (2 * levels)) tessellator.add_grid(first, levels);
  }
  CHECK(first == cell.owned_faces, "{} faces in squares, {} owned", first, cell.owned_faces);
  return tessellator.take();
}

}  // namespace meristem
