#include "geometry/cells/look_ahead.h"

#include "geometry/cells/level_of_detail.h"
#include "geometry/mesh/contraction.h"
#include "geometry/mesh/refine.h"

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

// Faces of the mesh ahead for each final face of the model: with 1/16, two levels of Catmull-Clark are left to
// analysis.
constexpr double analysed_share = 1.0 / 64;
constexpr std::uint32_t most_faces = 1u << 18;

// What analysis needs of one face and its neighbours; joined by union.
struct Surroundings {
  Bounds3d box;
  double edge = 0, contraction = 0;
  Vec2d lower_uv{INFINITY, INFINITY}, upper_uv{-INFINITY, -INFINITY};

  void join(const Surroundings& b) {
    box.extend(b.box);
    edge = std::max(edge, b.edge);
    contraction = std::max(contraction, b.contraction);
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
    for (std::size_t i = 0; i < c.size(); ++i) {
      ++faces[c[i]];
      parity[c[i]] ^= c[(i + 1) % c.size()] ^ c[(i + c.size() - 1) % c.size()];
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

// What analysis needs of groups of faces: of all within one ring of a group, and within two. A ring is the faces that
// share a vertex with what it lies around. Only faces at vertices where groups meet bring in anything that is not the
// group's own, and they are few.
class GroupRings {
 public:
  GroupRings(const Mesh& mesh, std::span<const std::uint32_t> group_of, std::size_t group_count)
      : mesh_(mesh),
        uv_(vertex_uv(mesh)),
        contraction_(vertex_contractions(mesh)),
        place_(mesh.vertex_count(), far_from_border) {
    find_border(group_of);
    const auto around = around_vertices();
    const auto around_rings = around_border(around);
    ring1.resize(group_count);
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
      if (!is_border_[v] && groups_[v] < group_count) ring1[groups_[v]].join(vertex(v));
    for (std::uint32_t f = 0; f < group_of.size(); ++f) {
      double& edge = ring1[group_of[f]].edge;
      edge = std::max(edge, longest_edge(mesh, f));
    }
    ring2 = ring1;
    for (std::uint32_t f : border_faces_) {
      if (f >= group_of.size()) continue;
      for (std::uint32_t v : mesh_.corners(f))
        if (is_border_[v]) {
          ring1[group_of[f]].join(around[place_[v]]);
          ring2[group_of[f]].join(around_rings[place_[v]]);
        }
    }
  }

  std::vector<Surroundings> ring1, ring2;  // by group

 private:
  static constexpr std::uint32_t far_from_border = ~0u;

  Surroundings vertex(std::uint32_t v) const {
    return {Bounds3d{mesh_.positions[v], mesh_.positions[v]}, 0, contraction_[v], uv_[v], uv_[v]};
  }
  Surroundings face(std::uint32_t f) const {
    Surroundings s;
    s.edge = longest_edge(mesh_, f);
    for (std::uint32_t v : mesh_.corners(f)) s.join(vertex(v));
    return s;
  }

  // Vertices that faces of several groups, or a group's and the halo's, share; and places for all vertices of their
  // faces.
  void find_border(std::span<const std::uint32_t> group_of) {
    constexpr std::uint32_t none = ~0u, halo = ~1u;
    groups_.resize(mesh_.vertex_count(), none);
    is_border_.resize(mesh_.vertex_count());
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
      const std::uint32_t g = f < group_of.size() ? group_of[f] : halo;
      for (std::uint32_t v : mesh_.corners(f)) {
        if (groups_[v] != none && groups_[v] != g) is_border_[v] = true;
        groups_[v] = g;
      }
    }
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
      const auto corners = mesh_.corners(f);
      if (std::ranges::none_of(corners, [&](std::uint32_t v) { return is_border_[v]; })) continue;
      border_faces_.push_back(f);
      for (std::uint32_t v : corners)
        if (place_[v] == far_from_border) place_[v] = places_++;
    }
  }

  // All faces around a vertex; of vertices with places.
  std::vector<Surroundings> around_vertices() const {
    std::vector<Surroundings> around(places_);
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
      std::optional<Surroundings> own;
      for (std::uint32_t v : mesh_.corners(f)) {
        if (place_[v] == far_from_border) continue;
        if (!own) own = face(f);
        around[place_[v]].join(*own);
      }
    }
    return around;
  }

  // All faces around a vertex and the ring around them; of the vertices at the border.
  std::vector<Surroundings> around_border(const std::vector<Surroundings>& around) const {
    std::vector<Surroundings> result(places_);
    for (std::uint32_t f : border_faces_) {
      Surroundings ring;
      for (std::uint32_t v : mesh_.corners(f)) ring.join(around[place_[v]]);
      for (std::uint32_t v : mesh_.corners(f)) result[place_[v]].join(ring);
    }
    return result;
  }

  const Mesh& mesh_;
  const std::vector<Vec2d> uv_;
  const std::vector<double> contraction_;
  std::vector<std::uint32_t> groups_;  // of vertices; at the border that of one of their faces
  std::vector<bool> is_border_;
  std::vector<std::uint32_t> border_faces_;  // with a vertex at the border
  std::vector<std::uint32_t> place_;         // of their vertices: in lists of what lies around
  std::uint32_t places_ = 0;
};

Extent extent_of(const Surroundings& ring1, const Surroundings& ring2) {
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
    while (level_ < grown_level_ && ahead_.owned_faces < most_faces) {
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

  void add_faces(std::vector<Outlook>& groups) {
    measure_nominal_scale(model_, ahead_, level_);
    for (std::uint32_t f = 0; f < ahead_.owned_faces; ++f)
      groups[ahead_.labels[f]].faces += is_final_ ? 1 : wanted_faces(model_, ahead_, f, level_);
  }

  // Before displacement at least once, so that all faces are quads (or triangles).
  void refine() {
    bool is_refined = !is_displaced_later();
    while (!is_final_ && level_ < model_.levels()) {
      is_final_ = freeze_vertices(model_, ahead_, level_);
      const bool is_worth_it = !is_refined || share() < analysed_share;
      if (is_final_ || !is_worth_it || ahead_.owned_faces >= most_faces) break;
      apply_step();
      is_refined = true;
    }
  }

  void add_bounds(std::vector<Outlook>& groups) const {
    const GroupRings rings(ahead_.mesh, std::span(ahead_.labels).first(ahead_.owned_faces), groups.size());
    // Of a mesh that is final nothing moves any more, but towards the limit surface
    const int level = is_final_ ? model_.levels() : level_;
    for (std::size_t g = 0; g < groups.size(); ++g)
      groups[g].bounds.extend(final_bounds(model_, extent_of(rings.ring1[g], rings.ring2[g]), level));
    add_frozen(groups);
  }

 private:
  void apply_step() {
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

  // By the refinements still wanted.
  double share() const { return std::exp2(-2.0 * wanted_refinements(model_, ahead_, level_)); }

  // Vertices that later levels would move, but which are shown where they are.
  void add_frozen(std::vector<Outlook>& groups) const {
    const Mesh& mesh = ahead_.mesh;
    if (mesh.frozen.empty()) return;
    std::vector<Bounds3d> frozen(groups.size());
    for (std::uint32_t f = 0; f < ahead_.owned_faces; ++f)
      for (std::uint32_t v : mesh.corners(f))
        if (mesh.frozen[v].is_frozen) frozen[ahead_.labels[f]].extend(Vec3d(mesh.frozen[v].position));
    for (std::size_t g = 0; g < groups.size(); ++g)
      if (!frozen[g].empty()) groups[g].bounds.extend(frozen[g].inflated(Vec3d(model_.quantum().step())));
  }

  const Model& model_;
  CellMesh ahead_;
  int level_;
  const int grown_level_;
  bool is_final_ = false;
};

}  // namespace

std::optional<std::vector<Outlook>> look_ahead(const Model& model, const CellMesh& cell, int level,
                                               std::span<const std::uint32_t> group_of, std::size_t group_count) {
  Lookahead ahead(model, cell, level, group_of);
  if (!ahead.grow()) return {};
  std::vector<Outlook> groups(group_count);
  ahead.add_faces(groups);
  ahead.refine();
  ahead.add_bounds(groups);
  return groups;
}

}  // namespace meristem
