#include "geometry/mesh/limit.h"

#include "geometry/base/check.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/crease.h"
#include "geometry/mesh/plan_table.h"
#include "geometry/mesh/refine.h"

#include <algorithm>
#include <span>

namespace meristem {

namespace {

using Rule = RefinePlan::Rule;

class LimitPlanBuilder {
 public:
  // Of those vertices of the owned faces for which wants(vertex) holds.
  template <class Wants>
  LimitPlanBuilder(const Mesh& mesh, std::uint32_t owned_faces, const RefineOptions& options, const Wants& wants)
      : mesh_(mesh), adjacency_(mesh), sharpness_(mesh, adjacency_, options) {
    plan_.scheme = options.scheme;
    std::vector<bool> seen(mesh.vertex_count(), false);
    for (std::uint32_t v : std::span(mesh.corner_vertices).first(mesh.face_starts[owned_faces])) {
      if (!seen[v] && wants(v)) add_vertex(v);
      seen[v] = true;
    }
  }
  LimitPlan take() { return std::move(plan_); }

 private:
  // What one face contributes to the ring around a vertex.
  struct Sector {
    std::uint32_t from, to, opposite;
  };

  void add_vertex(std::uint32_t v) {
    walk_around(v);
    const bool is_closed = sectors_.back().to == sectors_.front().from;
    const VertexCrease crease = sharpness_.vertex_rule(v);
    if (is_closed && crease.rule == Rule::Smooth && sectors_.size() == regular_valence())
      add_regular(v);
    else
      add_other(v, is_closed, crease);
  }

  bool is_loop() const { return plan_.scheme == Scheme::Loop; }
  std::size_t regular_valence() const { return is_loop() ? 6 : 4; }

  // Sorts the faces around v counter-clockwise into sectors_, on a boundary from its first face on.
  void walk_around(std::uint32_t v) {
    sectors_.clear();
    for (std::uint32_t f : adjacency_.faces_of_vertex(v)) {
      const auto c = mesh_.corners(f);
      const std::size_t n = c.size(), k = std::size_t(std::find(c.begin(), c.end(), v) - c.begin());
      CHECK(n == (is_loop() ? 3u : 4u), "face {} has {} corners", f, n);
      sectors_.push_back({c[(k + 1) % n], c[(k + n - 1) % n], c[(k + 2) % n]});
    }
    for (std::size_t i = 0; i < sectors_.size(); ++i) {
      const bool is_start =
          std::none_of(sectors_.begin(), sectors_.end(), [&](const Sector& s) { return s.to == sectors_[i].from; });
      if (is_start) std::swap(sectors_[0], sectors_[i]);
    }
    for (std::size_t i = 1; i < sectors_.size(); ++i) {
      const auto next = std::find_if(sectors_.begin() + std::ptrdiff_t(i), sectors_.end(),
                                     [&](const Sector& s) { return s.from == sectors_[i - 1].to; });
      CHECK(next != sectors_.end(), "the faces around vertex {} are not one fan", v);
      std::swap(sectors_[i], *next);
    }
  }

  void add_regular(std::uint32_t v) {
    LimitPlan::RegularVertex& vertex = plan_.regular.emplace_back();
    vertex.vertex = v;
    for (std::size_t i = 0; i < sectors_.size(); ++i) {
      vertex.ring[i] = sectors_[i].from;
      if (!is_loop()) vertex.ring[4 + i] = sectors_[i].opposite;
    }
  }

  void add_other(std::uint32_t v, bool is_closed, const VertexCrease& crease) {
    LimitPlan::OtherVertex vertex;
    vertex.vertex = v;
    vertex.first_point = std::uint32_t(plan_.points.size());
    vertex.face_count = std::uint32_t(sectors_.size());
    vertex.rule = crease.rule;
    // Two faces that meet along two edges leave nothing to smooth
    if (is_closed && sectors_.size() < 3) vertex.rule = Rule::Corner;
    for (const Sector& s : sectors_) plan_.points.push_back(s.from);
    if (!is_closed) plan_.points.push_back(sectors_.back().to);
    vertex.edge_count = std::uint32_t(plan_.points.size()) - vertex.first_point;
    if (vertex.rule == Rule::Crease) find_crease(v, crease, vertex);
    if (!is_loop())
      for (const Sector& s : sectors_) plan_.points.push_back(s.opposite);
    plan_.others.push_back(vertex);
  }

  void find_crease(std::uint32_t v, const VertexCrease& crease, LimitPlan::OtherVertex& vertex) const {
    const auto edges = plan_.points.begin() + vertex.first_point;
    for (int i = 0; i < 2; ++i) {
      const Adjacency::Edge& edge = adjacency_.edge(crease.edges[i]);
      const std::uint32_t end = edge.vertices[0] == v ? edge.vertices[1] : edge.vertices[0];
      vertex.crease[i] = std::uint32_t(std::find(edges, plan_.points.end(), end) - edges);
    }
    if (vertex.crease[0] > vertex.crease[1]) std::swap(vertex.crease[0], vertex.crease[1]);
  }

  const Mesh& mesh_;
  const Adjacency adjacency_;
  const CreaseSharpness sharpness_;
  std::vector<Sector> sectors_;
  LimitPlan plan_;
};

// The ring of a vertex as vectors from it: exact, positions being on a grid.
class Ring {
 public:
  Ring(const Mesh& mesh, std::uint32_t vertex, const std::uint32_t* edges, std::uint32_t edge_count,
       std::uint32_t face_count)
      : mesh_(mesh),
        center_(mesh.positions[vertex]),
        edges_(edges),
        faces_(edges + edge_count),
        edge_count_(edge_count),
        face_count_(face_count) {}

  std::uint32_t edge_count() const { return edge_count_; }
  std::uint32_t face_count() const { return face_count_; }
  Vec3d edge(std::uint32_t i) const { return mesh_.positions[edges_[i % edge_count_]] - center_; }
  Vec3d face(std::uint32_t i) const { return mesh_.positions[faces_[i % face_count_]] - center_; }  // quads only

  std::uint32_t smallest_edge() const {
    std::uint32_t smallest = 0;
    for (std::uint32_t i = 1; i < edge_count_; ++i)
      if (mesh_.vertex_keys[edges_[i]] < mesh_.vertex_keys[edges_[smallest]]) smallest = i;
    return smallest;
  }

 private:
  const Mesh& mesh_;
  const Vec3d center_;
  const std::uint32_t *const edges_, *const faces_;
  const std::uint32_t edge_count_, face_count_;
};

Vec3d face_normal(Vec3d from, Vec3d to) { return unit_quantum.round(normalize(cross(from, to))); }

// The mean of the normals of all faces around the vertex, each at its corner there.
Vec3d mean_normal(const Ring& ring) {
  Vec3d sum;
  for (std::uint32_t i = 0; i < ring.face_count(); ++i) sum += face_normal(ring.edge(i), ring.edge(i + 1));
  return normalize(sum);
}

// Catmull-Clark, quads all around: two tangents by the subdominant eigenvectors, with cos and sin of the angle of each
// edge.
Vec3d smooth_quad_normal(const Ring& ring) {
  const std::uint32_t n = ring.edge_count(), start = ring.smallest_edge();
  const double angle = 2 * pi / n, c = std::cos(angle);
  const double eigenvalue = (5 + c + std::cos(angle / 2) * std::sqrt(2 * (9 + c))) / 16;
  const double face_weight = 1 / (4 * eigenvalue - 1);
  Vec3d tangent_cos, tangent_sin;
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vec3d edge = ring.edge(start + i) * 4.0, face = ring.face(start + i) * face_weight;
    tangent_cos += edge * std::cos(i * angle) + face * (std::cos(i * angle) + std::cos((i + 1) * angle));
    tangent_sin += edge * std::sin(i * angle) + face * (std::sin(i * angle) + std::sin((i + 1) * angle));
  }
  return normalize(cross(tangent_cos, tangent_sin));
}

Vec3d smooth_triangle_normal(const Ring& ring) {
  const std::uint32_t n = ring.edge_count(), start = ring.smallest_edge();
  const double angle = 2 * pi / n;
  Vec3d tangent_cos, tangent_sin;
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vec3d edge = ring.edge(start + i);
    tangent_cos += edge * std::cos(i * angle);
    tangent_sin += edge * std::sin(i * angle);
  }
  return normalize(cross(tangent_cos, tangent_sin));
}

// The tangent across the `faces` quads between the crease's edge `first` and, counter-clockwise, its other edge: the
// left eigenvector of the rules that refine() applies there, with weights sin(i * angle) of the inner edges as in
// Biermann, Levin and Zorin 2000; theirs of the ends and the vertex go with rules that they modify near irregular
// vertices (with three faces or more). The vertex's own weight falls away, the ring being relative to it.
Vec3d quad_tangent_across(const Ring& ring, std::uint32_t first, std::uint32_t faces) {
  const Vec3d ends = ring.edge(first) + ring.edge(first + faces);
  if (faces == 1) return ends;
  if (faces == 2) return ring.edge(first + 1) * 4.0 - ends + ring.face(first) + ring.face(first + 1);
  const double angle = pi / faces, c = 1 + std::cos(angle), s = std::sin(angle);
  const double face_weight = 1 / (c + std::sqrt(c * (c + 8)));
  const double edge_sum = c / s;  // of all sin(i * angle)
  Vec3d tangent = ends * (face_weight * (s * (1 + 4 * face_weight) - 2 * edge_sum * (1 + 2 * face_weight)));
  for (std::uint32_t i = 0; i < faces; ++i)
    tangent += ring.edge(first + i) * std::sin(i * angle) +
               ring.face(first + i) * (face_weight * (std::sin(i * angle) + std::sin((i + 1) * angle)));
  return tangent;
}

// The same for triangles; Hoppe et al. 1994, appendix A, likewise.
Vec3d triangle_tangent_across(const Ring& ring, std::uint32_t first, std::uint32_t faces) {
  const Vec3d ends = ring.edge(first) + ring.edge(first + faces);
  if (faces == 1) return ends;
  if (faces == 2) return ring.edge(first + 1);
  if (faces == 3) return (ring.edge(first + 1) + ring.edge(first + 2)) * 2.0 - ends;
  const double angle = pi / faces, c = std::cos(angle), s = std::sin(angle);
  const double edge_sum = (1 + c) / s;
  Vec3d tangent = ends * ((s - edge_sum) / (1 + 2 * c));
  for (std::uint32_t i = 1; i < faces; ++i) tangent += ring.edge(first + i) * std::sin(i * angle);
  return tangent;
}

class LimitMasks {
 public:
  LimitMasks(const Mesh& mesh, const LimitPlan& plan) : mesh_(mesh), plan_(plan) {
    limit_.positions.resize(mesh.vertex_count());
    limit_.normals.resize(mesh.vertex_count());
    if (is_loop())
      for (const LimitPlan::RegularVertex& v : plan.regular) place_six_triangles(v);
    else
      for (const LimitPlan::RegularVertex& v : plan.regular) place_four_quads(v);
    for (const LimitPlan::OtherVertex& v : plan.others) place(v);
  }
  LimitSurface take() { return std::move(limit_); }

 private:
  bool is_loop() const { return plan_.scheme == Scheme::Loop; }
  Vec3d at(std::uint32_t v) const { return mesh_.positions[v]; }

  void set(std::uint32_t vertex, const Ring& ring, Vec3d position, Vec3d normal) {
    if (normal == Vec3d{}) normal = mean_normal(ring);
    limit_.positions[vertex] = position;
    limit_.normals[vertex] = normal + Vec3d{};  // no negative zeros: their sign depends on where the ring starts
  }

  // All sums are exact, and a ring that starts elsewhere gives the same product of tangents.
  void place_four_quads(const LimitPlan::RegularVertex& v) {
    const std::uint32_t* r = v.ring;
    const Vec3d e0 = at(r[0]), e1 = at(r[1]), e2 = at(r[2]), e3 = at(r[3]);
    const Vec3d f0 = at(r[4]), f1 = at(r[5]), f2 = at(r[6]), f3 = at(r[7]);
    const Vec3d sum = at(v.vertex) * 16.0 + (e0 + e1 + e2 + e3) * 4.0 + (f0 + f1 + f2 + f3);
    const Vec3d diagonal0 = f0 - f2, diagonal1 = f1 - f3;
    const Vec3d tangent0 = (e0 - e2) * 4.0 + (diagonal0 - diagonal1),
                tangent1 = (e1 - e3) * 4.0 + (diagonal0 + diagonal1);
    set(v.vertex, Ring(mesh_, v.vertex, r, 4, 4), sum * (1.0 / 36), normalize(cross(tangent0, tangent1)));
  }

  void place_six_triangles(const LimitPlan::RegularVertex& v) {
    const Ring ring(mesh_, v.vertex, v.ring, 6, 6);
    const std::uint32_t start = ring.smallest_edge();
    const auto e = [&](std::uint32_t i) { return at(v.ring[(start + i) % 6]); };
    const Vec3d a = e(0) - e(3), b = e(1) - e(4), c = e(2) - e(5);
    const Vec3d sum = at(v.vertex) * 6.0 + (e(0) + e(1) + e(2) + e(3) + e(4) + e(5));
    set(v.vertex, ring, sum * (1.0 / 12), normalize(cross(a * 2.0 + b - c, b + c)));
  }

  void place(const LimitPlan::OtherVertex& v) {
    const Ring ring(mesh_, v.vertex, &plan_.points[v.first_point], v.edge_count, v.face_count);
    switch (v.rule) {
      case Rule::Corner: return set(v.vertex, ring, at(v.vertex), Vec3d{});
      case Rule::Crease: return set(v.vertex, ring, crease_position(v), crease_normal(v, ring));
      case Rule::Smooth: break;
    }
    if (is_loop())
      set(v.vertex, ring, smooth_triangle_position(v), smooth_triangle_normal(ring));
    else
      set(v.vertex, ring, smooth_quad_position(v), smooth_quad_normal(ring));
  }

  std::span<const std::uint32_t> points(const LimitPlan::OtherVertex& v, std::uint32_t from,
                                        std::uint32_t count) const {
    return {&plan_.points[v.first_point] + from, count};
  }
  Vec3d exact_sum(std::span<const std::uint32_t> vertices) const {
    Vec3d sum;
    for (std::uint32_t v : vertices) sum += at(v);
    return sum;
  }

  // n/(n + 5) of the vertex, 4 and 1 parts of 1/(n (n + 5)) of each edge's end and each face's opposite corner.
  Vec3d smooth_quad_position(const LimitPlan::OtherVertex& v) const {
    const double n = v.edge_count;
    const Vec3d ring = exact_sum(points(v, 0, v.edge_count)) * 4.0 + exact_sum(points(v, v.edge_count, v.face_count));
    return (at(v.vertex) * n + ring * (1 / n)) * (1 / (n + 5));
  }

  // 1/(n + 3/(8 beta)) of each neighbour, with Loop's beta.
  Vec3d smooth_triangle_position(const LimitPlan::OtherVertex& v) const {
    const double n = v.edge_count, c = 0.375 + 0.25 * std::cos(2 * pi / n);
    const double weight = 1 / (n + 0.375 * n / (0.625 - c * c));
    return at(v.vertex) * (1 - n * weight) + exact_sum(points(v, 0, v.edge_count)) * weight;
  }

  Vec3d crease_position(const LimitPlan::OtherVertex& v) const {
    const auto edges = points(v, 0, v.edge_count);
    return (at(v.vertex) * 4.0 + at(edges[v.crease[0]]) + at(edges[v.crease[1]])) * (1.0 / 6);
  }

  // On a boundary the normal of its one side; within a surface the mean of both.
  Vec3d crease_normal(const LimitPlan::OtherVertex& v, const Ring& ring) const {
    const std::uint32_t first = v.crease[0], second = v.crease[1], faces = second - first;
    const Vec3d normal = side_normal(ring, first, faces);
    const bool is_boundary = v.face_count < v.edge_count;
    return is_boundary ? normalize(normal) : normalize(normal + side_normal(ring, second, v.face_count - faces));
  }

  // Of the `faces` between two edges of a crease, the first of them at `first`.
  Vec3d side_normal(const Ring& ring, std::uint32_t first, std::uint32_t faces) const {
    const Vec3d along = ring.edge(first) - ring.edge(first + faces);
    return face_normal(
        along, is_loop() ? triangle_tangent_across(ring, first, faces) : quad_tangent_across(ring, first, faces));
  }

  const Mesh& mesh_;
  const LimitPlan& plan_;
  LimitSurface limit_;
};

template <class T>
std::size_t capacity_bytes(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

}  // namespace

std::size_t LimitPlan::bytes() const {
  return sizeof(*this) + capacity_bytes(regular) + capacity_bytes(others) + capacity_bytes(points);
}

std::shared_ptr<const LimitPlan> make_limit_plan(const Mesh& mesh, std::uint32_t owned_faces,
                                                 const RefineOptions& options) {
  return std::make_shared<const LimitPlan>(
      LimitPlanBuilder(mesh, owned_faces, options, [](std::uint32_t) { return true; }).take());
}

namespace {

// A leaf of 32 x 32 quads takes some 50 KB, so about 600 shapes stay.
PlanTable<LimitPlan>& plan_table() {
  static PlanTable<LimitPlan> table;
  return table;
}

}  // namespace

std::size_t limit_plan_bytes() { return plan_table().bytes(); }

void set_limit_plan_capacity(std::size_t bytes) { plan_table().set_capacity(bytes); }

LimitSurface limit_surface(const Mesh& mesh, const LimitPlan& plan) { return LimitMasks(mesh, plan).take(); }

LimitSurface limit_surface(const Mesh& mesh, std::uint32_t owned_faces, const RefineOptions& options) {
  const auto plan = plan_table().get(shape_name(mesh, owned_faces, options.bits()),
                                     [&] { return make_limit_plan(mesh, owned_faces, options); });
  return limit_surface(mesh, *plan);
}

LimitSurface limit_surface_of_cage(const Mesh& cage, std::uint32_t owned_faces, const RefineOptions& options,
                                   const Quantum& quantum) {
  constexpr std::uint64_t of_cage = 256;  // beside the bits of options
  const auto refinement = shared_refine_plan(cage, owned_faces, 1, options);
  const Mesh refined = refine(cage, *refinement, quantum, 0).mesh;
  const auto plan = plan_table().get(shape_name(cage, owned_faces, options.bits() | of_cage), [&] {
    const auto comes_of_vertex = [&](std::uint32_t v) { return refinement->kinds[v] == VertexKind::Vertex; };
    return std::make_shared<const LimitPlan>(
        LimitPlanBuilder(refined, refinement->owned_faces, options, comes_of_vertex).take());
  });
  const LimitSurface limit = limit_surface(refined, *plan);
  LimitSurface surface{std::vector<Vec3d>(cage.vertex_count()), std::vector<Vec3d>(cage.vertex_count())};
  for (const RefinePlan::VertexVertex& v : refinement->vertex_vertices) {
    if (v.out >= refinement->kept_vertices) continue;
    surface.positions[v.vertex] = limit.positions[v.out];
    surface.normals[v.vertex] = limit.normals[v.out];
  }
  return surface;
}

}  // namespace meristem
