#include "geometry/cells/look_ahead.h"

#include "geometry/base/parallel.h"
#include "geometry/cells/fading.h"
#include "geometry/cells/level_of_detail.h"
#include "geometry/mesh/contraction.h"
#include "geometry/mesh/refine.h"

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

// Levels that are left to analysis.
constexpr int analysed_refinements = 3;
// Faces of a grown mesh that are refined together.
constexpr std::uint32_t part_faces = 512;

// What analysis needs of all faces within one ring; joined by union.
struct Ring1 {
  Bounds3d box;
  double contraction = 0;

  void join(const Ring1& b) {
    box.extend(b.box);
    contraction = std::max(contraction, b.contraction);
  }
};

// And within two.
struct Ring2 {
  double edge = 0;
  Vec2d lower_uv{INFINITY, INFINITY}, upper_uv{-INFINITY, -INFINITY};

  void join(const Ring2& b) {
    edge = std::max(edge, b.edge);
    lower_uv = {std::min(lower_uv.x, b.lower_uv.x), std::min(lower_uv.y, b.lower_uv.y)};
    upper_uv = {std::max(upper_uv.x, b.upper_uv.x), std::max(upper_uv.y, b.upper_uv.y)};
  }
};

// A bound on the contraction of edges at every vertex, from the faces around it: of a closed fan of quads without
// creases each neighbour is met twice, so that the exclusive or of all neighbours' indices vanishes.
std::vector<double> vertex_contractions(const Mesh& mesh) {
  std::vector<std::uint32_t> faces(mesh.vertex_count(), 0), parity(mesh.vertex_count(), 0);
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto c = mesh.corners(f);
    std::uint32_t before = c.back();
    for (std::size_t i = 0; i < c.size(); ++i) {
      ++faces[c[i]];
      parity[c[i]] ^= before ^ (i + 1 < c.size() ? c[i + 1] : c[0]);
      before = c[i];
    }
  }
  const bool has_creases = !mesh.corner_sharpness.empty() || !mesh.vertex_sharpness.empty();
  std::vector<double> result(mesh.vertex_count());
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
    result[v] = has_creases || parity[v] != 0 || faces[v] < 3 ? worst_contraction : smooth_contraction(faces[v]);
  return result;
}

double longest_edge(const Mesh& mesh, std::uint32_t f) {
  const auto c = mesh.corners(f);
  double longest = length_squared(mesh.positions[c.back()] - mesh.positions[c[0]]);
  for (std::size_t i = 1; i < c.size(); ++i)
    longest = std::max(longest, length_squared(mesh.positions[c[i]] - mesh.positions[c[i - 1]]));
  return std::sqrt(longest);
}

// What analysis needs of groups of faces. A ring is the faces that share a vertex with what it lies around. Only faces
// at vertices where groups meet bring in anything that is not the group's own.
class GroupRings {
 public:
  GroupRings(const Mesh& mesh, std::span<const std::uint32_t> group_of, std::size_t group_count)
      : ring1(group_count),
        ring2(group_count),
        mesh_(mesh),
        uv_(vertex_uv(mesh)),
        contraction_(vertex_contractions(mesh)),
        groups_(mesh.vertex_count(), no_group),
        is_border_(mesh.vertex_count()),
        place_(mesh.vertex_count(), no_place) {
    find_border(group_of);
    add_own(group_of);
    add_around_border(group_of);
  }

  std::vector<Ring1> ring1;  // by group
  std::vector<Ring2> ring2;

 private:
  static constexpr std::uint32_t no_group = ~0u, halo = ~1u, no_place = ~0u;

  Ring1 vertex_ring1(std::uint32_t v) const {
    return {Bounds3d{mesh_.positions[v], mesh_.positions[v]}, contraction_[v]};
  }
  Ring2 vertex_ring2(std::uint32_t v) const { return {0, uv_[v], uv_[v]}; }

  // Vertices that faces of several groups, or a group's and the halo's, share; and places for all vertices of their
  // faces.
  void find_border(std::span<const std::uint32_t> group_of) {
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
      const std::uint32_t g = f < group_of.size() ? group_of[f] : halo;
      for (std::uint32_t v : mesh_.corners(f)) {
        if (groups_[v] != no_group && groups_[v] != g) is_border_[v] = true;
        groups_[v] = g;
      }
    }
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
      const auto corners = mesh_.corners(f);
      if (std::ranges::none_of(corners, [&](std::uint32_t v) { return is_border_[v]; })) continue;
      border_faces_.push_back(f);
      for (std::uint32_t v : corners)
        if (place_[v] == no_place) place_[v] = places_++;
    }
  }

  // The groups themselves, but for what lies at their border.
  void add_own(std::span<const std::uint32_t> group_of) {
    for (std::uint32_t v = 0; v < mesh_.vertex_count(); ++v) {
      if (is_border_[v] || groups_[v] >= ring1.size()) continue;
      ring1[groups_[v]].join(vertex_ring1(v));
      ring2[groups_[v]].join(vertex_ring2(v));
    }
    edges_.resize(mesh_.face_count());
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
      edges_[f] = longest_edge(mesh_, f);
      if (f < group_of.size()) ring2[group_of[f]].edge = std::max(ring2[group_of[f]].edge, edges_[f]);
    }
  }

  void add_around_border(std::span<const std::uint32_t> group_of) {
    // All faces around a vertex; of vertices with places
    std::vector<Ring1> around1(places_);
    std::vector<Ring2> around2(places_);
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
      const auto corners = mesh_.corners(f);
      if (std::ranges::all_of(corners, [&](std::uint32_t v) { return place_[v] == no_place; })) continue;
      Ring1 face1;
      Ring2 face2{.edge = edges_[f]};
      for (std::uint32_t v : corners) {
        face1.join(vertex_ring1(v));
        face2.join(vertex_ring2(v));
      }
      for (std::uint32_t v : corners) {
        if (place_[v] == no_place) continue;
        around1[place_[v]].join(face1);
        around2[place_[v]].join(face2);
      }
    }
    // And the ring around them; of the vertices at the border
    std::vector<Ring2> around_rings(places_);
    for (std::uint32_t f : border_faces_) {
      Ring2 ring;
      for (std::uint32_t v : mesh_.corners(f)) ring.join(around2[place_[v]]);
      for (std::uint32_t v : mesh_.corners(f)) around_rings[place_[v]].join(ring);
    }
    for (std::uint32_t f : border_faces_) {
      if (f >= group_of.size()) continue;
      for (std::uint32_t v : mesh_.corners(f))
        if (is_border_[v]) {
          ring1[group_of[f]].join(around1[place_[v]]);
          ring2[group_of[f]].join(around_rings[place_[v]]);
        }
    }
  }

  const Mesh& mesh_;
  const std::vector<Vec2d> uv_;
  const std::vector<double> contraction_;
  std::vector<double> edges_;          // of faces: the longest
  std::vector<std::uint32_t> groups_;  // of vertices; at the border that of one of their faces
  std::vector<std::uint8_t> is_border_;
  std::vector<std::uint32_t> border_faces_;  // with a vertex at the border
  std::vector<std::uint32_t> place_;         // of their vertices: in lists of what lies around
  std::uint32_t places_ = 0;
};

Extent extent_of(const Ring1& ring1, const Ring2& ring2) {
  Extent e;
  e.box = ring1.box;
  e.edge = ring2.edge;
  e.edge_sum = 2 * ring2.edge;
  e.contraction = e.next_contraction = ring1.contraction;
  auto outwards = [](double lower, double upper) {
    return Interval{std::nextafterf(float(lower), -INFINITY), std::nextafterf(float(upper), INFINITY)};
  };
  e.u = outwards(ring2.lower_uv.x, ring2.upper_uv.x);
  e.v = outwards(ring2.lower_uv.y, ring2.upper_uv.y);
  return e;
}

// A cell's mesh carried on, every owned face labelled with its group.
class Lookahead {
 public:
  Lookahead(const Model& model, const CellMesh& cell, int level, std::span<const std::uint32_t> group_of)
      : model_(model), ahead_(cell), level_(level), grown_level_(model.levels() - model.trailing_refinements(level)) {
    ahead_.labels.assign(group_of.begin(), group_of.end());
  }

  // Until only refinements follow or nothing finer is wanted; whether that was reached. Growth moves no vertex, so that
  // it does not matter when before a refinement they freeze.
  bool grow() {
    while (level_ < grown_level_ && ahead_.owned_faces < most_faces_) {
      if (model_.step(level_).refines()) {
        is_final_ = freeze_vertices(model_, ahead_, level_);
        if (is_final_) return true;
      } else {
        measure_nominal_scale(model_, ahead_, level_);
        leave_out_small_growth(model_, ahead_, level_);
      }
      apply_step();
    }
    return level_ >= grown_level_;
  }

  void add_faces(std::span<Outlook> groups) {
    measure_nominal_scale(model_, ahead_, level_);
    for (std::uint32_t f = 0; f < ahead_.owned_faces; ++f)
      groups[ahead_.labels[f]].faces += is_final_ ? 1 : wanted_faces(model_, ahead_, f, level_);
  }

  // Refines a grown mesh part by part: threads that wait for it may take one, and what comes of a part is still in the
  // processor's cache when it is bounded.
  void refine_and_bound(std::span<Outlook> groups) {
    std::vector<std::uint32_t> sizes(groups.size()), starts{0};
    for (std::uint32_t f = 0; f < ahead_.owned_faces; ++f) ++sizes[ahead_.labels[f]];
    for (std::uint32_t end = 0; end < groups.size(); starts.push_back(end))
      for (std::uint32_t faces = 0; end < groups.size() && faces < part_faces; ++end) faces += sizes[end];
    if (starts.size() == 2) return refine_and_bound_together(groups);
    parallel_for(starts.size() - 1, [&](std::size_t i) {
      const std::uint32_t first = starts[i], end = starts[i + 1];
      part(first, end).refine_and_bound_together(groups.subspan(first, end - first));
    });
  }

 private:
  Lookahead(const Lookahead& whole, CellMesh part)
      : model_(whole.model_),
        ahead_(std::move(part)),
        level_(whole.level_),
        grown_level_(whole.grown_level_),
        most_faces_(whole.most_faces_ * ahead_.owned_faces / whole.ahead_.owned_faces),
        is_final_(whole.is_final_) {}

  // The faces of groups [first, end) with their halo, labelled anew from 0 on.
  Lookahead part(std::uint32_t first, std::uint32_t end) const {
    std::vector<std::uint32_t> faces;
    for (std::uint32_t f = 0; f < ahead_.owned_faces; ++f)
      if (first <= ahead_.labels[f] && ahead_.labels[f] < end) faces.push_back(f);
    CellMesh part = cell_of_faces(ahead_, faces, model_.halo_rings(level_));
    for (std::uint32_t& label : part.labels) label -= first;
    return {*this, std::move(part)};
  }

  // Before displacement at least once, so that all faces are quads (or triangles). A group that analysis is good enough
  // for is not carried further with those that want finer faces.
  void refine_and_bound_together(std::span<Outlook> groups) {
    bool is_refined = !is_displaced_later();
    while (true) {
      std::vector<std::uint8_t> wanted;
      is_final_ = is_final_ || level_ == model_.levels() || freeze_vertices(model_, ahead_, level_, &wanted);
      if (is_final_ || ahead_.owned_faces >= most_faces_) break;
      if (is_refined && bound_fine_groups(groups, wanted)) return;
      apply_step();
      is_refined = true;
    }
    add_bounds(groups, std::vector<bool>(groups.size(), true));
  }

  // Bounds groups whose vertices want no more refinements than analysis may carry, and takes them out of the mesh, if
  // they are enough to be worth it; returns whether no others are left.
  bool bound_fine_groups(std::span<Outlook> groups, const std::vector<std::uint8_t>& wanted) {
    constexpr double worth_taking = 0.25;
    std::vector<bool> is_fine(groups.size(), true);
    std::vector<std::uint32_t> others;
    for (std::uint32_t f = 0; f < ahead_.owned_faces; ++f)
      for (std::uint32_t v : ahead_.mesh.corners(f))
        if (wanted[v] > analysed_refinements) is_fine[ahead_.labels[f]] = false;
    for (std::uint32_t f = 0; f < ahead_.owned_faces; ++f)
      if (!is_fine[ahead_.labels[f]]) others.push_back(f);
    if (double(others.size()) > (1 - worth_taking) * ahead_.owned_faces) return false;
    add_bounds(groups, is_fine);
    if (others.empty()) return true;
    ahead_ = cell_of_faces(ahead_, others, model_.halo_rings(level_));
    return false;
  }

  // Of those of the groups that have faces left.
  void add_bounds(std::span<Outlook> groups, const std::vector<bool>& is_asked) const {
    const GroupRings rings(ahead_.mesh, std::span(ahead_.labels).first(ahead_.owned_faces), groups.size());
    // Of a mesh that is final nothing moves any more, but towards the limit surface
    const int level = is_final_ ? model_.levels() : level_;
    for (std::size_t g = 0; g < groups.size(); ++g)
      if (is_asked[g] && !rings.ring1[g].box.empty())
        groups[g].bounds.extend(final_bounds(model_, extent_of(rings.ring1[g], rings.ring2[g]), level));
    add_frozen(groups, is_asked);
  }

  void apply_step() {
    if (model_.step(level_).refines()) begin_fading(model_, ahead_, level_);
    CellMesh out;
    model_.step(level_).apply(ahead_, model_.halo_rings(level_ + 1), out);
    out.footprint = ahead_.footprint;
    ahead_ = std::move(out);
    ++level_;
  }

  bool is_displaced_later() const {
    for (int level = level_; level < model_.levels(); ++level)
      if (model_.step(level).displaces()) return true;
    return false;
  }

  // Vertices that later levels would move, but which are shown where they are.
  void add_frozen(std::span<Outlook> groups, const std::vector<bool>& is_asked) const {
    const Mesh& mesh = ahead_.mesh;
    if (mesh.frozen.empty() && mesh.fading.empty()) return;
    std::vector<Bounds3d> frozen(groups.size());
    for (std::uint32_t f = 0; f < ahead_.owned_faces; ++f)
      for (std::uint32_t v : mesh.corners(f)) extend_by_earlier_levels(mesh, v, frozen[ahead_.labels[f]]);
    for (std::size_t g = 0; g < groups.size(); ++g)
      if (is_asked[g] && !frozen[g].empty())
        groups[g].bounds.extend(frozen[g].inflated(Vec3d(model_.quantum().step())));
  }

  const Model& model_;
  CellMesh ahead_;
  int level_;
  const int grown_level_;
  const double most_faces_ = 1 << 18;  // it is carried no further where it has more
  bool is_final_ = false;
};

}  // namespace

std::optional<std::vector<Outlook>> look_ahead(const Model& model, const CellMesh& cell, int level,
                                               std::span<const std::uint32_t> group_of, std::size_t group_count) {
  Lookahead ahead(model, cell, level, group_of);
  if (!ahead.grow()) return {};
  std::vector<Outlook> groups(group_count);
  ahead.add_faces(groups);
  ahead.refine_and_bound(groups);
  return groups;
}

}  // namespace meristem
