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
  double longest = 0;
  for (std::size_t i = 0; i < c.size(); ++i)
    longest = std::max(longest, length(mesh.positions[c[i]] - mesh.positions[c[(i + 1) % c.size()]]));
  return longest;
}

std::vector<Surroundings> own_surroundings(const Mesh& mesh) {
  const std::vector<Vec2d> uv = vertex_uv(mesh);
  const std::vector<double> contraction = vertex_contractions(mesh);
  std::vector<Surroundings> result(mesh.face_count());
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    Surroundings& s = result[f];
    s.edge = longest_edge(mesh, f);
    for (std::uint32_t v : mesh.corners(f))
      s.join({Bounds3d{mesh.positions[v], mesh.positions[v]}, 0, contraction[v], uv[v], uv[v]});
  }
  return result;
}

// Every face's surroundings joined with those of all faces that share a vertex with it: one ring more.
std::vector<Surroundings> widened(const Mesh& mesh, const std::vector<Surroundings>& faces) {
  std::vector<Surroundings> vertices(mesh.vertex_count()), result(mesh.face_count());
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    for (std::uint32_t v : mesh.corners(f)) vertices[v].join(faces[f]);
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    for (std::uint32_t v : mesh.corners(f)) result[f].join(vertices[v]);
  return result;
}

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
    const std::vector<Surroundings> ring1 = widened(ahead_.mesh, own_surroundings(ahead_.mesh)),
                                    ring2 = widened(ahead_.mesh, ring1);
    std::vector<Surroundings> group_ring1(groups.size()), group_ring2(groups.size());
    for (std::uint32_t f = 0; f < ahead_.owned_faces; ++f) {
      group_ring1[ahead_.labels[f]].join(ring1[f]);
      group_ring2[ahead_.labels[f]].join(ring2[f]);
    }
    // Of a mesh that is final nothing moves any more, but towards the limit surface
    const int level = is_final_ ? model_.levels() : level_;
    for (std::size_t g = 0; g < groups.size(); ++g)
      groups[g].bounds.extend(final_bounds(model_, extent_of(group_ring1[g], group_ring2[g]), level));
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
