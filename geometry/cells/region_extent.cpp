#include "geometry/cells/region_extent.h"

#include "geometry/cells/fading.h"
#include "geometry/cells/footprint.h"
#include "geometry/cells/position_lattice.h"
#include "geometry/mesh/contraction.h"
#include "geometry/mesh/refine.h"

#include <algorithm>

namespace meristem {

namespace {

// Collects the faces within two rings of a region, ring 1 first.
struct Neighborhood {
  std::vector<std::uint32_t> ring1, ring2;

  Neighborhood(const Mesh& mesh, const Adjacency& adjacency, std::span<const std::uint32_t> faces) {
    if (faces.size() == mesh.face_count()) return;
    std::vector<std::uint32_t> seen(faces.begin(), faces.end());
    std::sort(seen.begin(), seen.end());
    ring1 = ring_around(mesh, adjacency, faces, seen);
    ring2 = ring_around(mesh, adjacency, ring1, seen);
  }

 private:
  static std::vector<std::uint32_t> ring_around(const Mesh& mesh, const Adjacency& adjacency,
                                                std::span<const std::uint32_t> faces,
                                                std::vector<std::uint32_t>& seen) {
    std::vector<std::uint32_t> ring;
    for (std::uint32_t f : faces)
      for (std::uint32_t v : mesh.corners(f))
        for (std::uint32_t g : adjacency.faces_of_vertex(v))
          if (!std::binary_search(seen.begin(), seen.end(), g)) ring.push_back(g);
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    const auto middle = seen.insert(seen.end(), ring.begin(), ring.end());
    std::inplace_merge(seen.begin(), middle, seen.end());
    return ring;
  }
};

double face_edge(const Mesh& mesh, std::uint32_t f) {
  const auto c = mesh.corners(f);
  double longest = 0;
  for (std::size_t i = 0; i < c.size(); ++i)
    for (std::size_t j = i + 1; j < c.size(); ++j) {
      const bool is_edge = c.size() != 4 || j == i + 1 || (i == 0 && j == 3);
      if (is_edge) longest = std::max(longest, length(mesh.positions[c[i]] - mesh.positions[c[j]]));
    }
  return longest;
}

Interval outwards(double lower, double upper) {
  return {std::nextafterf(float(lower), -INFINITY), std::nextafterf(float(upper), INFINITY)};
}

class ExtentBuilder {
 public:
  ExtentBuilder(const Model& model, const Mesh& mesh, const Adjacency& adjacency, int level)
      : model_(model), mesh_(mesh), adjacency_(adjacency), level_(level) {
    extent_.contraction = extent_.next_contraction = 0;
  }

  void add_control_face(std::uint32_t f) {
    for (std::uint32_t v : mesh_.corners(f)) extent_.box.extend(mesh_.positions[v]);
    const FaceOrigin& origin = mesh_.origins[mesh_.face_origins[f]];
    if (model_.grows_later(origin.symbol, level_)) add_symbol(f, origin);
  }

  void add_scale_face(std::uint32_t f) {
    extent_.edge = std::max(extent_.edge, face_edge(mesh_, f));
    const std::uint32_t n = mesh_.corner_count(f);
    if (n != 4) {
      has_other_faces_ = true;
      extent_.next_contraction = std::max(extent_.next_contraction, general_contraction(n));
    }
    for (std::uint32_t c = mesh_.face_starts[f]; c < mesh_.face_starts[f + 1]; ++c) {
      const std::uint32_t v = mesh_.corner_vertices[c];
      const Vec2d uv = !mesh_.uv.empty() ? mesh_.uv[v] : !mesh_.corner_uv.empty() ? mesh_.corner_uv[c] : Vec2d{};
      add_uv(uv);
      if (has_seams(mesh_)) add_uv(mesh_.corner_uv[c]);  // what grows on the face sees its own
    }
  }

  // Vertices of the owned faces and ring 1: only these are smoothed for the region's sake.
  void add_smoothed_face(std::uint32_t f) {
    for (std::uint32_t v : mesh_.corners(f)) add_smoothed_vertex(v);
  }
  void add_smoothed_vertices_of_all() {
    for (std::uint32_t v = 0; v < mesh_.vertex_count(); ++v)
      if (!adjacency_.faces_of_vertex(v).empty()) add_smoothed_vertex(v);
  }

  // Once all faces are added. `scale_faces`: those given to add_scale_face().
  Extent take(std::span<const std::uint32_t> scale_faces) {
    if (!first_uv_) {
      extent_.u = outwards(lower_uv_.x, upper_uv_.x);
      extent_.v = outwards(lower_uv_.y, upper_uv_.y);
    }
    extent_.edge_sum = longest_edge_sum(scale_faces);
    extent_.next_contraction = std::max(extent_.next_contraction, extent_.contraction);
    if (has_other_faces_) extent_.contraction = worst_first_contraction;
    return std::move(extent_);
  }

 private:
  void add_uv(Vec2d uv) {
    lower_uv_ = first_uv_ ? uv : Vec2d{std::min(lower_uv_.x, uv.x), std::min(lower_uv_.y, uv.y)};
    upper_uv_ = first_uv_ ? uv : Vec2d{std::max(upper_uv_.x, uv.x), std::max(upper_uv_.y, uv.y)};
    first_uv_ = false;
  }
  void add_smoothed_vertex(std::uint32_t v) {
    extent_.contraction = std::max(extent_.contraction, smoothing_contraction(adjacency_, v));
  }

  // Sorts the edges of quads into two directions by walking from face to face (opposite edges of a face share one), and
  // adds the longest of each; twice the longest edge if a face is no quad or the walk contradicts itself around an
  // irregular vertex.
  double longest_edge_sum(std::span<const std::uint32_t> faces) const {
    if (has_other_faces_) return 2 * extent_.edge;
    constexpr std::int8_t outside = -2, unknown = -1;
    std::vector<std::int8_t> turn(mesh_.face_count(), outside);  // of every face: the direction of its edges 0 and 2
    for (std::uint32_t f : faces) turn[f] = unknown;
    double longest[2] = {0, 0};
    std::vector<std::uint32_t> walk;
    for (std::uint32_t start : faces) {
      if (turn[start] == unknown) {
        turn[start] = 0;
        walk.push_back(start);
      }
      if (!walk.empty() && start != faces.front())
        return 2 * extent_.edge;  // a second piece: its directions are unknown
      while (!walk.empty()) {
        const std::uint32_t f = walk.back();
        walk.pop_back();
        for (int k = 0; k < 4; ++k) {
          const Adjacency::Edge& edge =
              adjacency_.edge(adjacency_.edge_of_corner(mesh_.face_starts[f] + std::uint32_t(k)));
          const int direction = (turn[f] + k) % 2;
          longest[direction] = std::max(longest[direction],
                                        length(mesh_.positions[edge.vertices[0]] - mesh_.positions[edge.vertices[1]]));
          const std::uint32_t g = edge.faces[0] == f ? edge.faces[1] : edge.faces[0];
          if (g == Adjacency::none || turn[g] == outside) continue;
          const auto other_turn = std::int8_t((direction + side_of(g, edge)) % 2);
          if (turn[g] == unknown) {
            turn[g] = other_turn;
            walk.push_back(g);
          } else if (turn[g] != other_turn) {
            return 2 * extent_.edge;
          }
        }
      }
    }
    return longest[0] + longest[1];
  }

  // Which edge of face g it is, counted from corner 0.
  int side_of(std::uint32_t g, const Adjacency::Edge& edge) const {
    const std::uint32_t start = mesh_.face_starts[g];
    for (std::uint32_t k = 0; k < mesh_.corner_count(g); ++k)
      if (&adjacency_.edge(adjacency_.edge_of_corner(start + k)) == &edge) return int(k);
    return 0;
  }

  void add_symbol(std::uint32_t f, const FaceOrigin& origin) {
    const FaceFrame frame = face_frame(mesh_, f);
    double radius = 0;
    for (std::uint32_t v : mesh_.corners(f)) radius = std::max(radius, length(mesh_.positions[v] - frame.origin));
    const float enlargement = mesh_.enlargements.empty() ? 1 : mesh_.enlargements[f].of_face;
    radius /= double(enlargement);
    auto range = std::find_if(extent_.symbols.begin(), extent_.symbols.end(),
                              [&](const SymbolRange& s) { return s.symbol == origin.symbol; });
    const bool is_new = range == extent_.symbols.end();
    if (is_new) range = extent_.symbols.insert(range, SymbolRange{origin.symbol, {}, 0, {enlargement, enlargement}, 0});
    range->radius = std::max(range->radius, std::nextafterf(float(radius), INFINITY));
    range->enlargement = {std::min(range->enlargement.lower, enlargement),
                          std::max(range->enlargement.upper, enlargement)};
    if (enlargement > 1) range->enlarged_reach = INFINITY;
    for (std::size_t i = 0; i < range->parameters.size(); ++i) {
      Interval& p = range->parameters[i];
      const float x = origin.parameters[i];
      p = is_new ? Interval{x, x} : Interval{std::min(p.lower, x), std::max(p.upper, x)};
    }
  }

  const Model& model_;
  const Mesh& mesh_;
  const Adjacency& adjacency_;
  const int level_;
  Extent extent_;
  Vec2d lower_uv_, upper_uv_;
  bool first_uv_ = true, has_other_faces_ = false;
};

}  // namespace

Extent region_extent(const Model& model, const Mesh& mesh, const Adjacency& adjacency,
                     std::span<const std::uint32_t> faces, int level) {
  const Neighborhood neighborhood(mesh, adjacency, faces);
  ExtentBuilder builder(model, mesh, adjacency, level);
  for (std::uint32_t f : faces) builder.add_control_face(f);
  for (std::uint32_t f : neighborhood.ring1) builder.add_control_face(f);
  if (faces.size() == mesh.face_count()) {
    builder.add_smoothed_vertices_of_all();
  } else {
    for (std::uint32_t f : faces) builder.add_smoothed_face(f);
    for (std::uint32_t f : neighborhood.ring1) builder.add_smoothed_face(f);
  }
  std::vector<std::uint32_t> all(faces.begin(), faces.end());
  all.insert(all.end(), neighborhood.ring1.begin(), neighborhood.ring1.end());
  all.insert(all.end(), neighborhood.ring2.begin(), neighborhood.ring2.end());
  for (std::uint32_t f : all) builder.add_scale_face(f);
  return builder.take(all);
}

namespace {

// Where vertices of the faces stay, or fade in from, that were shown on an earlier level: later ones have moved away.
Bounds3d frozen_bounds(const Model& model, const Mesh& mesh, std::span<const std::uint32_t> faces) {
  Bounds3d bounds;
  if (mesh.frozen.empty() && mesh.fading.empty()) return bounds;
  for (std::uint32_t f : faces)
    for (std::uint32_t v : mesh.corners(f)) extend_by_earlier_levels(mesh, v, bounds);
  return bounds.empty() ? bounds : bounds.inflated(Vec3d(model.quantum().step()));
}

// What thins is enlarged by the footprint where it stands: at first that may be anywhere, then no further than the
// bounds so far. Always as often, so that what stands in a part of a region has bounds in those of the region.
Bounds3d seen_bounds(const Model& model, Extent e, int level, const Footprint* footprint) {
  e.footprint = footprint ? INFINITY : 0;
  Bounds3d bounds = final_bounds(model, e, level);
  if (!footprint || !model.enlarges_later(level)) return bounds;
  for (int i = 0; i < footprint_passes; ++i) {
    e.footprint = footprint->range(bounds).most;
    bounds = final_bounds(model, e, level);
  }
  return bounds;
}

// But for the rounding of what is shown.
Bounds3d bounds_before_rounding(const Model& model, const CellMesh& cell, const Adjacency& adjacency,
                                std::span<const std::uint32_t> faces, int level, int derived_levels) {
  const Mesh& mesh = cell.mesh;
  const auto bounds_of = [&](std::span<const std::uint32_t> part) {
    return seen_bounds(model, region_extent(model, mesh, adjacency, part, level), level, cell.footprint);
  };
  std::vector<std::uint32_t> derived, others;
  Bounds3d box;
  int after = level;
  for (std::uint32_t f : faces) {
    const auto corners = mesh.corners(f);
    const bool is_alone = std::all_of(corners.begin(), corners.end(),
                                      [&](std::uint32_t v) { return adjacency.faces_of_vertex(v).size() == 1; });
    const int step = model.growing_step(mesh.origins[mesh.face_origins[f]].symbol, level);
    const auto of_face =
        is_alone && step < model.levels() ? model.step(step).derive(cell, f, derived_levels) : std::nullopt;
    (of_face ? derived : others).push_back(f);
    if (!of_face) continue;
    box.extend(of_face->box);
    after = std::max(after, step + of_face->levels);
  }
  Bounds3d bounds = frozen_bounds(model, mesh, faces);
  if (!others.empty()) bounds.extend(bounds_of(others));
  if (derived.empty()) return bounds;
  Extent e = region_extent(model, mesh, adjacency, derived, level);
  for (int i = level; i < after; ++i) e = model.step(i).bound(e);
  e.box = box;
  bounds.extend(final_bounds(model, e, after));
  return bounds;
}

}  // namespace

Bounds3d region_bounds(const Model& model, const CellMesh& cell, const Adjacency& adjacency,
                       std::span<const std::uint32_t> faces, int level, int derived_levels) {
  return bounds_before_rounding(model, cell, adjacency, faces, level, derived_levels)
      .inflated(Vec3d(PositionLattice::margin(model)));
}

}  // namespace meristem
