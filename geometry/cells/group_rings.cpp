#include "geometry/cells/group_rings.h"

#include "geometry/cells/extent.h"
#include "geometry/mesh/contraction.h"
#include "geometry/mesh/refine.h"

namespace meristem {

namespace {

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

double longest_edge_squared(const Mesh& mesh, std::uint32_t f) {
  const auto c = mesh.corners(f);
  double longest = length_squared(mesh.positions[c.back()] - mesh.positions[c[0]]);
  for (std::size_t i = 1; i < c.size(); ++i)
    longest = std::max(longest, length_squared(mesh.positions[c[i]] - mesh.positions[c[i - 1]]));
  return longest;
}

// Only faces at vertices where groups meet bring in anything that is not the group's own.
class RingBuilder {
 public:
  RingBuilder(const Mesh& mesh, std::span<const std::uint32_t> group_of, std::size_t group_count)
      : mesh_(mesh),
        means_(mesh.uv.empty() ? vertex_uv(mesh) : std::vector<Vec2d>()),
        uv_(mesh.uv.empty() ? means_ : mesh.uv),
        contraction_(vertex_contractions(mesh)),
        groups_(mesh.vertex_count(), no_group),
        is_border_(mesh.vertex_count()),
        place_(mesh.vertex_count(), no_place) {
    rings_.ring1.resize(group_count);
    rings_.ring2.resize(group_count);
    find_border(group_of);
    add_own(group_of);
    add_around_border(group_of);
    for (Ring2& ring : rings_.ring2) ring.edge = std::sqrt(ring.edge);
  }

  GroupRings take() { return std::move(rings_); }

 private:
  static constexpr std::uint32_t no_group = ~0u, halo = ~1u, no_place = ~0u;

  // Where one step of Catmull-Clark may put what becomes of a face around its corner i: refined vertices are means of
  // old ones, of the middles of edges and of faces, with weights that are not negative where three faces or more lie
  // around the vertex; new ones on edges are means of the middles of edge and faces. The vertex itself is added for all
  // of its faces at once, and of the two edges there one: the other is that of the next face of the closed fan.
  void add_refined_corner(std::span<const std::uint32_t> corners, std::size_t i, const Bounds3d& face, Vec3d middle,
                          Bounds3d& box) const {
    const std::uint32_t v = corners[i];
    if (!(contraction_[v] < worst_contraction)) return box.extend(face);
    box.extend(middle);
    box.extend((mesh_.positions[v] + mesh_.positions[corners[i + 1 < corners.size() ? i + 1 : 0]]) * 0.5);
  }

  void add_vertex(std::uint32_t v, Ring1& ring) const {
    ring.box.extend(mesh_.positions[v]);
    ring.contraction = std::max(ring.contraction, contraction_[v]);
  }
  void add_vertex(std::uint32_t v, Ring2& ring) const {
    const Vec2d uv = uv_[v];
    ring.lower_uv = {std::min(ring.lower_uv.x, uv.x), std::min(ring.lower_uv.y, uv.y)};
    ring.upper_uv = {std::max(ring.upper_uv.x, uv.x), std::max(ring.upper_uv.y, uv.y)};
  }

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
      if (is_border_[v] || groups_[v] >= rings_.ring1.size()) continue;
      add_vertex(v, rings_.ring1[groups_[v]]);
      rings_.ring1[groups_[v]].refined_box.extend(mesh_.positions[v]);
      add_vertex(v, rings_.ring2[groups_[v]]);
    }
    edges_.resize(mesh_.face_count());
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
      edges_[f] = longest_edge_squared(mesh_, f);
      if (f < group_of.size()) rings_.ring2[group_of[f]].edge = std::max(rings_.ring2[group_of[f]].edge, edges_[f]);
    }
  }

  void add_around_border(std::span<const std::uint32_t> group_of) {
    // All faces around a vertex; of vertices with places
    std::vector<Ring1> around1(places_);
    std::vector<Ring2> around2(places_);
    for (std::uint32_t v = 0; v < mesh_.vertex_count(); ++v)
      if (is_border_[v]) around1[place_[v]].refined_box.extend(mesh_.positions[v]);
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
      const auto corners = mesh_.corners(f);
      if (std::ranges::all_of(corners, [&](std::uint32_t v) { return place_[v] == no_place; })) continue;
      Ring1 face1;
      Ring2 face2{.edge = edges_[f]};
      Vec3d middle;
      for (std::uint32_t v : corners) {
        add_vertex(v, face1);
        add_vertex(v, face2);
        middle += mesh_.positions[v];
      }
      middle = middle * (1.0 / double(corners.size()));
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const std::uint32_t v = corners[i];
        if (place_[v] == no_place) continue;
        around2[place_[v]].join(face2);
        if (!is_border_[v]) continue;  // of others the second ring alone is asked for
        Ring1& around = around1[place_[v]];
        around.box.extend(face1.box);
        around.contraction = std::max(around.contraction, face1.contraction);
        add_refined_corner(corners, i, face1.box, middle, around.refined_box);
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
          rings_.ring1[group_of[f]].join(around1[place_[v]]);
          rings_.ring2[group_of[f]].join(around_rings[place_[v]]);
        }
    }
  }

  GroupRings rings_;
  const Mesh& mesh_;
  const std::vector<Vec2d> means_;  // of the u, v of corners, if vertices have none
  const std::vector<Vec2d>& uv_;
  const std::vector<double> contraction_;
  std::vector<double> edges_;          // of faces: the square of the longest, as in ring2 until the end
  std::vector<std::uint32_t> groups_;  // of vertices; at the border that of one of their faces
  std::vector<std::uint8_t> is_border_;
  std::vector<std::uint32_t> border_faces_;  // with a vertex at the border
  std::vector<std::uint32_t> place_;         // of their vertices: in lists of what lies around
  std::uint32_t places_ = 0;
};

}  // namespace

GroupRings rings_of_groups(const Mesh& mesh, std::span<const std::uint32_t> group_of, std::size_t group_count) {
  return RingBuilder(mesh, group_of, group_count).take();
}

}  // namespace meristem
