#include "geometry/cells/probe.h"

#include "geometry/cells/level_of_detail.h"
#include "geometry/mesh/contraction.h"
#include "geometry/mesh/refine.h"

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

// Faces of the mesh ahead for each final face of the model: with 1/16, two levels of Catmull-Clark are left to
// analysis.
constexpr double probe_share = 1.0 / 64;
constexpr std::uint32_t most_probe_faces = 1u << 18;

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

}  // namespace

std::vector<Bounds3d> probed_bounds(const Model& model, const CellMesh& cell, int level,
                                    std::span<const std::uint32_t> group_of, std::size_t group_count) {
  CellMesh ahead = cell;
  std::vector<std::uint32_t> groups(group_of.begin(), group_of.end());  // of the owned faces of `ahead`
  // By the refinements still wanted; frozen vertices, which later levels would move, count as they are.
  auto share = [&] { return std::exp2(-2.0 * wanted_refinements(model, ahead, level)); };
  std::vector<Bounds3d> frozen(group_count);
  auto add_frozen = [&] {
    if (ahead.mesh.frozen.empty()) return;
    for (std::uint32_t f = 0; f < ahead.owned_faces; ++f)
      for (std::uint32_t v : ahead.mesh.corners(f))
        if (ahead.mesh.frozen[v].is_frozen) frozen[groups[f]].extend(Vec3d(ahead.mesh.frozen[v].position));
  };
  bool is_quads = false;
  while (level < model.levels() && (!is_quads || share() < probe_share) && ahead.owned_faces < most_probe_faces) {
    std::vector<std::uint32_t> next_groups;
    for (std::uint32_t f = 0; f < ahead.owned_faces; ++f)
      next_groups.insert(next_groups.end(), model.step(level).max_children(ahead.mesh.corner_count(f)), groups[f]);
    CellMesh out;
    model.step(level).apply(ahead, model.halo_rings(level + 1), out);
    out.footprint = ahead.footprint;
    ahead = std::move(out);
    groups = std::move(next_groups);
    is_quads = true;
    ++level;
    if (freeze_vertices(model, ahead, level)) break;
  }
  add_frozen();
  const std::vector<Surroundings> ring1 = widened(ahead.mesh, own_surroundings(ahead.mesh)),
                                  ring2 = widened(ahead.mesh, ring1);
  std::vector<Surroundings> group_ring1(group_count), group_ring2(group_count);
  for (std::uint32_t f = 0; f < ahead.owned_faces; ++f) {
    group_ring1[groups[f]].join(ring1[f]);
    group_ring2[groups[f]].join(ring2[f]);
  }
  std::vector<Bounds3d> bounds;
  for (std::size_t g = 0; g < group_count; ++g) {
    bounds.push_back(final_bounds(model, extent_of(group_ring1[g], group_ring2[g]), level));
    if (!frozen[g].empty()) bounds.back().extend(frozen[g].inflated(Vec3d(model.quantum().step())));
  }
  return bounds;
}

}  // namespace meristem
