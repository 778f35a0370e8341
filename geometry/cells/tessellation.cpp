#include "geometry/cells/tessellation.h"

#include "geometry/base/check.h"
#include "geometry/cells/fading.h"
#include "geometry/cells/position_lattice.h"
#include "geometry/cells/uv_lattice.h"
#include "geometry/cells/uv_packing.h"
#include "geometry/mesh/face_sums.h"
#include "geometry/mesh/refine.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>

namespace meristem {

namespace {

template <class T>
std::size_t capacity_bytes(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

bool has_quads_alone(const Mesh& mesh) {
  for (std::size_t f = 0; f < mesh.face_starts.size(); ++f)
    if (mesh.face_starts[f] != 4 * f) return false;
  return true;
}

// The mean of the unit normals of the faces that meet in a vertex.
void find_vertex_normals(const Mesh& mesh, Vec3d* normals) {
  Scratch<FaceSum> sums(mesh.vertex_count(), FaceSum{});
  if (has_quads_alone(mesh)) {
    add_quads(mesh.positions, mesh.corner_vertices, Quantum(), sums.span());
  } else {
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      const auto corners = mesh.corners(f);
      const Vec3d normal = unit_face_normal(mesh.positions, corners.data(), std::uint32_t(corners.size()));
      for (std::uint32_t v : corners) sums[v].normal += normal;
    }
  }
  unit_normals(sums.span(), normals);
}

LimitSurface limit_of(const CellMesh& cell, const Smoothing& smoothing) {
  return smoothing.is_refined ? limit_surface(cell.mesh, cell.owned_faces, smoothing.scheme)
                              : limit_surface_of_cage(cell.mesh, cell.owned_faces, smoothing.scheme, smoothing.quantum);
}

// The surface that is shown, and where its u, v lie, if they are wanted: the mesh's own arrays where it is shown as it
// is.
class ShownSurface {
 public:
  ShownSurface(const CellMesh& cell, const std::optional<Smoothing>& smoothing, bool has_uv)
      : normals_(smoothing ? 0 : cell.mesh.vertex_count()) {
    if (smoothing) {
      limit_ = limit_of(cell, *smoothing);
      positions = limit_.positions;
      normals = limit_.normals;
    } else {
      find_vertex_normals(cell.mesh, normals_.data());
      positions = cell.mesh.positions;
      normals = normals_.span();
    }
    if (!has_uv) return;
    if (cell.mesh.uv.empty()) uv_ = vertex_uv(cell.mesh);
    uv = cell.mesh.uv.empty() ? uv_ : cell.mesh.uv;
    uv_lattice.emplace(cell.mesh, uv);
  }
  ShownSurface(const ShownSurface&) = delete;
  ShownSurface& operator=(const ShownSurface&) = delete;

 private:
  LimitSurface limit_;
  Scratch<Vec3d> normals_;
  std::vector<Vec2d> uv_;

 public:
  std::span<const Vec3d> positions, normals;
  std::span<const Vec2d> uv;
  std::optional<UvLattice> uv_lattice;
};

std::size_t squares_of(std::uint32_t corners) { return corners == 4 ? 1 : corners; }
int levels_of(std::uint32_t corners, int refinements) { return corners == 4 ? refinements : refinements - 1; }

// The vertices of the grids of all squares, if nothing of them is frozen.
std::size_t vertices_of(const Squares& squares) {
  std::size_t vertices = 0;
  for (std::uint32_t corners : squares.corners) {
    const std::size_t width = (std::size_t(1) << levels_of(corners, squares.refinements)) + 1;
    vertices += squares_of(corners) * width * width;
  }
  return vertices;
}

// The surface of some faces of a mesh, appended to what there is of others.
class Tessellator {
 public:
  // `surface` and `lattice` are not asked for frozen vertices: null where all are.
  Tessellator(const Mesh& mesh, int level, std::optional<Scheme> next_scheme, const ShownSurface* surface,
              const PositionLattice* lattice, Tessellation& out, std::vector<Vec2f>& vertex_uv,
              std::vector<UvRange>& uv_ranges)
      : mesh_(mesh),
        next_scheme_(next_scheme),
        surface_(surface),
        lattice_(lattice),
        out_(out),
        vertex_uv_(vertex_uv),
        uv_ranges_(uv_ranges),
        leaf_(std::uint32_t(out.leaves.size())),
        has_seams_(out.has_uv && meristem::has_seams(mesh)),
        origins_(mesh.origins.size(), none) {
    out.leaves.push_back({{}, level});
  }

  // Faces [0, count).
  void add(std::uint32_t count, const Squares& squares) {
    out_.face_count += count;
    if (squares.refinements < 1) {
      for (std::uint32_t f = 0; f < count; ++f) add_polygon(f);
      return;
    }
    std::uint32_t first = 0;
    for (std::uint32_t corners : squares.corners) {
      const int levels = levels_of(corners, squares.refinements);
      const std::uint32_t end = first + squares.faces_of(corners);
      for (; first < end; first += 1u << (2 * levels)) add_grid(first, levels);
    }
    CHECK(first == count, "{} faces in squares, {} owned", first, count);
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t(0);

  // A square of 4^levels faces from `first` on: their order is that of a quadtree whose children run around the face.
  void add_grid(std::uint32_t first, int levels) {
    const std::uint32_t side = 1u << levels, width = side + 1;
    grid_vertices_.assign(std::size_t(width) * width, 0);
    if (has_seams_) grid_uv_.assign(std::size_t(width) * width, {});
    for (std::uint32_t k = 0; k < side * side; ++k) {
      std::uint32_t i = 0, j = 0;
      for (int level = levels; level-- > 0;) {
        const std::uint32_t child = k >> (2 * level) & 3;
        i = i * 2 + (child == 1 || child == 2);
        j = j * 2 + (child >= 2);
      }
      const auto c = mesh_.corners(first + k);
      const std::uint32_t places[4] = {j * width + i, j * width + i + 1, (j + 1) * width + i + 1, (j + 1) * width + i};
      for (std::uint32_t corner = 0; corner < 4; ++corner) {
        grid_vertices_[places[corner]] = c[corner];
        if (has_seams_) grid_uv_[places[corner]] = own_uv(first + k, corner);
      }
    }
    grid_width_ = width;
    grid_origin_ = origin_of(first);
    add_square(0, 0, side);
  }

  // Those of the halo are not kept.
  std::uint32_t origin_of(std::uint32_t face) {
    std::uint32_t& number = origins_[mesh_.face_origins[face]];
    if (number == none) number = out_.origins.add(mesh_.origins[mesh_.face_origins[face]]);
    return number;
  }

  // Quads are cut as those of grids are, others into a fan from the first corner, or as the next refinement would cut
  // them; vertices are shared between faces.
  void add_polygon(std::uint32_t face) {
    const auto c = mesh_.corners(face);
    if (c.size() == 4) {
      add_triangle(face, c[0], c[1], c[3]);
      add_triangle(face, c[2], c[3], c[1]);
      return;
    }
    if (next_scheme_ == Scheme::CatmullClark) return add_as_quads(face);
    for (std::size_t i = 1; i + 1 < c.size(); ++i) add_triangle(face, c[0], c[i], c[i + 1]);
  }

  // The quads that refinement makes of a face that is done, without what it puts on edges and in the face: shown where
  // these are shown.
  void add_as_quads(std::uint32_t face) {
    const auto c = mesh_.corners(face);
    const std::uint32_t center = done_face_place(mesh_, face);
    std::uint32_t before = done_edge_place(mesh_, c.back(), c.front());
    for (std::size_t i = 0; i < c.size(); ++i) {
      const std::uint32_t after = done_edge_place(mesh_, c[i], c[(i + 1) % c.size()]);
      add_triangle(face, c[i], after, before);
      add_triangle(face, center, before, after);
      before = after;
    }
  }

  void add_triangle(std::uint32_t face, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (is_shown_together(a, b) || is_shown_together(b, c) || is_shown_together(c, a)) return;
    out_.triangles.push_back({shared_vertex(face, a), shared_vertex(face, b), shared_vertex(face, c)});
    out_.triangle_sources.push_back({origin_of(face), leaf_});
  }

  std::uint32_t grid_vertex(std::uint32_t i, std::uint32_t j) const { return grid_vertices_[j * grid_width_ + i]; }

  // The coarsest spacing (a power of two) of a square of the grid beyond which all vertices are copies of others.
  std::uint32_t spacing(std::uint32_t i0, std::uint32_t j0, std::uint32_t size) const {
    if (mesh_.frozen.empty()) return 1;
    for (std::uint32_t step = 1; step < size; step *= 2)
      for (std::uint32_t j = 0; j <= size; j += step)
        for (std::uint32_t i = 0; i <= size; i += step)
          if (((i | j) & step) && !mesh_.frozen[grid_vertex(i0 + i, j0 + j)].is_copy) return step;
    return size;
  }

  void add_quarters(std::uint32_t i0, std::uint32_t j0, std::uint32_t size) {
    const std::uint32_t half = size / 2;
    for (std::uint32_t k = 0; k < 4; ++k) add_square(i0 + (k % 2) * half, j0 + (k / 2) * half, half);
  }

  // As one grid, or as four where one of these may be coarser, or where no frame holds all of its u, v.
  void add_square(std::uint32_t i0, std::uint32_t j0, std::uint32_t size) {
    constexpr std::uint32_t smallest_split = 16;
    const std::uint32_t step = spacing(i0, j0, size), half = size / 2;
    if (!mesh_.frozen.empty() && size / step >= smallest_split) {
      const std::uint32_t steps[4] = {spacing(i0, j0, half), spacing(i0 + half, j0, half), spacing(i0, j0 + half, half),
                                      spacing(i0 + half, j0 + half, half)};
      if (*std::max_element(steps, steps + 4) > step) return add_quarters(i0, j0, size);
    }
    const auto base = std::uint32_t(out_.positions.size());
    const auto width = std::uint16_t(size / step + 1);
    for (std::uint32_t j = 0; j <= size; j += step)
      for (std::uint32_t i = 0; i <= size; i += step) {
        const std::uint32_t added = add_vertex(grid_vertex(i0 + i, j0 + j));
        if (has_seams_) vertex_uv_[added] = grid_uv_[(j0 + j) * grid_width_ + i0 + i];
      }
    if (out_.has_uv) {
      UvRange range;
      for (std::size_t v = base; v < vertex_uv_.size(); ++v) range.add(vertex_uv_[v]);
      if (size > step && !range.fits()) {
        out_.positions.resize(base);
        out_.attributes.resize(base);
        vertex_uv_.resize(base);
        return add_quarters(i0, j0, size);
      }
      uv_ranges_.push_back(range);
    }
    out_.grids.push_back({base, width, width, grid_origin_, leaf_, std::countr_zero(step)});
  }

  bool is_shown_together(std::uint32_t v, std::uint32_t w) const {
    if (v == w) return true;
    return !mesh_.frozen.empty() && mesh_.frozen[v].is_frozen && mesh_.frozen[w].is_frozen &&
           mesh_.frozen[v].position == mesh_.frozen[w].position;
  }

  std::uint32_t add_vertex(std::uint32_t v) {
    if (!mesh_.frozen.empty() && mesh_.frozen[v].is_frozen) {
      const FrozenVertex& frozen = mesh_.frozen[v];
      return add_vertex(frozen.position + Vec3f(0.f), frozen.normal, frozen.uv);  // no zero is -0
    }
    Vec2f uv;
    if (out_.has_uv) uv = {float(surface_->uv[v].x), float(surface_->uv[v].y)};
    const FadingVertex shown = faded(mesh_, v, Vec3f(surface_->positions[v]), Vec3f(surface_->normals[v]), uv);
    return add_vertex(lattice_->round(v, shown.position), shown.normal,
                      out_.has_uv ? surface_->uv_lattice->round(v, shown.uv) : uv);
  }
  std::uint32_t add_vertex(Vec3f position, Vec3f normal, Vec2f uv) {
    out_.positions.push_back(position);
    out_.attributes.push_back({PackedNormal::pack(normal), {}});
    if (out_.has_uv) vertex_uv_.push_back(uv);
    return std::uint32_t(out_.positions.size()) - 1;
  }
  std::uint32_t shared_vertex(std::uint32_t face, std::uint32_t v) {
    if (has_seams_) return vertex_of_face(face, v);
    if (shared_.empty()) shared_.assign(mesh_.vertex_count(), none);
    if (shared_[v] == none) shared_[v] = add_vertex(v);
    return shared_[v];
  }

  // Of a mesh with seams: one for each pair of u, v that faces have there.
  std::uint32_t vertex_of_face(std::uint32_t face, std::uint32_t v) {
    const auto corners = mesh_.corners(face);
    const Vec2f uv = own_uv(face, std::uint32_t(std::ranges::find(corners, v) - corners.begin()));
    std::vector<std::uint32_t>& known = split_[v];
    for (const std::uint32_t vertex : known)
      if (vertex_uv_[vertex] == uv) return vertex;
    known.push_back(add_vertex(v));
    vertex_uv_[known.back()] = uv;
    return known.back();
  }
  Vec2f own_uv(std::uint32_t face, std::uint32_t corner) const {
    const std::uint32_t c = mesh_.face_starts[face] + corner, v = mesh_.corner_vertices[c];
    const Vec2f uv{float(mesh_.corner_uv[c].x), float(mesh_.corner_uv[c].y)};
    return !mesh_.frozen.empty() && mesh_.frozen[v].is_frozen ? uv : surface_->uv_lattice->round(v, uv);
  }

  const Mesh& mesh_;
  const std::optional<Scheme> next_scheme_;
  const ShownSurface* const surface_;
  const PositionLattice* const lattice_;
  Tessellation& out_;
  std::vector<Vec2f>& vertex_uv_;    // of the output
  std::vector<UvRange>& uv_ranges_;  // of its grids
  const std::uint32_t leaf_;
  const bool has_seams_;  // in u, v, if these are wanted
  std::vector<std::uint32_t> origins_;  // by number in the mesh: in the tessellation
  std::vector<std::uint32_t> grid_vertices_, shared_;
  std::vector<Vec2f> grid_uv_;                                           // of a mesh with seams
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> split_;  // likewise: the vertices there
  std::uint32_t grid_width_ = 0, grid_origin_ = 0;
};

// Vectors may have grown by doubling. Those of vertices are packed by whoever keeps the surface.
void shrink_to_fit(Tessellation& t) {
  t.grids.shrink_to_fit();
  t.triangles.shrink_to_fit();
  t.triangle_sources.shrink_to_fit();
  t.origins.shrink_to_fit();
}

bool reads_uv(const UvReaders& readers, const Mesh& mesh, std::uint32_t faces) {
  std::uint32_t last = ~std::uint32_t(0);
  for (std::uint32_t f = 0; f < faces; ++f) {
    const std::uint32_t origin = mesh.face_origins[f];
    if (origin != last && readers.reads(mesh.origins[origin])) return true;
    last = origin;
  }
  return false;
}

}  // namespace

LimitSurface shown_surface(const CellMesh& cell, const std::optional<Smoothing>& smoothing) {
  if (smoothing) return limit_of(cell, *smoothing);
  LimitSurface surface{cell.mesh.positions, std::vector<Vec3d>(cell.mesh.vertex_count())};
  find_vertex_normals(cell.mesh, surface.normals.data());
  return surface;
}

std::size_t SurfaceFaces::bytes() const {
  return capacity_bytes(grids) + capacity_bytes(triangles) + capacity_bytes(triangle_sources) + capacity_bytes(leaves) +
         origins.bytes();
}

Bounds3f Tessellation::bounds() const {
  Bounds3f b;
  for (Vec3f p : positions) b.extend(p);
  return b;
}

Tessellation tessellate(const Model& model, const CellMesh& cell, int level, const Squares& squares,
                        std::span<const DoneFaces> done, const UvReaders& uv_readers) {
  Tessellation out;
  out.has_uv = reads_uv(uv_readers, cell.mesh, cell.owned_faces) ||
               std::any_of(done.begin(), done.end(),
                           [&](const DoneFaces& d) { return reads_uv(uv_readers, d.mesh, d.mesh.face_count()); });
  std::vector<Vec2f> vertex_uv;
  std::vector<UvRange> uv_ranges;
  if (squares.refinements > 0 && cell.mesh.frozen.empty()) {
    const std::size_t vertices = vertices_of(squares);
    out.positions.reserve(vertices + 1);
    out.attributes.reserve(vertices);
    if (out.has_uv) vertex_uv.reserve(vertices);
  }
  const ShownSurface surface(cell, model.smoothing(level), out.has_uv);
  const PositionLattice lattice(model, cell);
  Tessellator(cell.mesh, level, model.next_scheme(level), &surface, &lattice, out, vertex_uv, uv_ranges)
      .add(cell.owned_faces, squares);
  for (const DoneFaces& d : done)
    Tessellator(d.mesh, d.level, model.next_scheme(d.level), nullptr, nullptr, out, vertex_uv, uv_ranges)
        .add(d.mesh.face_count(), d.squares);
  if (out.has_uv) pack_uv(vertex_uv, uv_ranges, out);
  shrink_to_fit(out);
  return out;
}

}  // namespace meristem
