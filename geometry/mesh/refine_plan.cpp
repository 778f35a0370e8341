#include "geometry/mesh/refine_plan.h"

#include "geometry/base/check.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/crease.h"
#include "geometry/mesh/plan_table.h"
#include "geometry/mesh/rings.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace meristem {

namespace {

using Plan = RefinePlan;

// A refined vertex before numbering: face f is f, edge e is faces + e, vertex v is faces + edges + v.
class ChildNumbers {
 public:
  ChildNumbers(const Mesh& mesh, const Adjacency& adjacency, Scheme scheme)
      : faces_(scheme == Scheme::CatmullClark ? mesh.face_count() : 0),
        edges_(adjacency.edge_count()),
        count_(faces_ + edges_ + mesh.vertex_count()) {}
  std::uint32_t of_face(std::uint32_t f) const { return f; }
  std::uint32_t of_edge(std::uint32_t e) const { return faces_ + e; }
  std::uint32_t of_vertex(std::uint32_t v) const { return faces_ + edges_ + v; }
  std::uint32_t count() const { return count_; }
  VertexKind kind(std::uint32_t n) const {
    return n < faces_ ? VertexKind::Face : n < faces_ + edges_ ? VertexKind::Edge : VertexKind::Vertex;
  }
  std::uint32_t source(std::uint32_t n) const {
    return n < faces_ ? n : n < faces_ + edges_ ? n - faces_ : n - faces_ - edges_;
  }

 private:
  std::uint32_t faces_, edges_, count_;
};

// One refined face: its corners (ChildNumbers), and for each the input edge whose half its outgoing edge is (or none);
// all these halves end at the input vertex `vertex`.
struct Child {
  std::uint32_t parent;
  std::uint8_t index;
  std::uint32_t vertex;
  std::uint32_t corners[4];
  std::uint32_t edges[4];
};

class PlanBuilder {
 public:
  PlanBuilder(const Mesh& mesh, std::uint32_t owned, int rings_after, const RefineOptions& options)
      : mesh_(mesh),
        options_(options),
        adjacency_(mesh),
        number_(mesh, adjacency_, options.scheme),
        sharpness_(mesh, adjacency_, options) {
    find_children(owned, rings_after);
    keep_faces(rings_after);
    add_normal_faces();
    write_vertices();
  }
  Plan take() { return std::move(plan_); }

 private:
  std::uint32_t corner_count() const { return options_.scheme == Scheme::CatmullClark ? 4 : 3; }

  void find_children(std::uint32_t owned, int rings_after) {
    const std::vector<std::uint8_t> rings = face_rings(mesh_, owned, (rings_after + 2) / 2);
    children_.reserve(mesh_.corner_vertices.size() + mesh_.face_count() / 2);
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
      if (rings[f] == unreached_ring) continue;
      if (options_.scheme == Scheme::CatmullClark)
        add_quads(f);
      else
        add_triangles(f);
      if (f < owned) plan_.owned_faces = std::uint32_t(children_.size());
    }
  }

  // Quads keep their turning: child i has the refined corner i at its corner i, so that the children of a quad make a
  // grid.
  void add_quads(std::uint32_t f) {
    const std::uint32_t n = mesh_.corner_count(f), start = mesh_.face_starts[f];
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t next = adjacency_.edge_of_corner(start + i),
                          previous = adjacency_.edge_of_corner(start + (i + n - 1) % n);
      const std::uint32_t ring[4] = {number_.of_vertex(mesh_.corner_vertices[start + i]), number_.of_edge(next),
                                     number_.of_face(f), number_.of_edge(previous)};
      const std::uint32_t edges[4] = {next, Plan::none, Plan::none, previous};
      Child child{f, std::uint8_t(i), mesh_.corner_vertices[start + i], {}, {}};
      const std::uint32_t turn = n == 4 ? i : 0;
      for (std::uint32_t k = 0; k < 4; ++k) {
        child.corners[(k + turn) % 4] = ring[k];
        child.edges[(k + turn) % 4] = edges[k];
      }
      children_.push_back(child);
    }
  }

  void add_triangles(std::uint32_t f) {
    if (mesh_.corner_count(f) != 3)
      throw std::runtime_error(
          fmt::format("the scheme loop needs triangles, and a face has {} corners", mesh_.corner_count(f)));
    const std::uint32_t start = mesh_.face_starts[f];
    const auto c = mesh_.corners(f);
    std::uint32_t v[3], e[3];
    for (std::uint32_t i = 0; i < 3; ++i) {
      v[i] = number_.of_vertex(c[i]);
      e[i] = adjacency_.edge_of_corner(start + i);
    }
    const std::uint32_t m[3] = {number_.of_edge(e[0]), number_.of_edge(e[1]), number_.of_edge(e[2])};
    children_.push_back({f, 0, c[0], {v[0], m[0], m[2], 0}, {e[0], Plan::none, e[2], 0}});
    children_.push_back({f, 1, c[1], {m[0], v[1], m[1], 0}, {e[0], e[1], Plan::none, 0}});
    children_.push_back({f, 2, c[2], {m[2], m[1], v[2], 0}, {Plan::none, e[1], e[2], 0}});
    children_.push_back({f, 3, Plan::none, {m[0], m[1], m[2], 0}, {Plan::none, Plan::none, Plan::none, 0}});
  }

  // Rings of the refined faces, by breadth-first search as face_rings() does.
  std::vector<std::uint8_t> child_rings(int max_ring) const {
    std::vector<std::uint8_t> rings(children_.size(), unreached_ring), touched(number_.count(), 0);
    std::fill_n(rings.begin(), plan_.owned_faces, std::uint8_t(0));
    for (int ring = 1; ring <= max_ring; ++ring) {
      for (std::size_t c = 0; c < children_.size(); ++c)
        if (rings[c] == ring - 1)
          for (std::uint32_t k = 0; k < corner_count(); ++k) touched[children_[c].corners[k]] = 1;
      for (std::size_t c = plan_.owned_faces; c < children_.size(); ++c)
        for (std::uint32_t k = 0; rings[c] == unreached_ring && k < corner_count(); ++k)
          if (touched[children_[c].corners[k]]) rings[c] = std::uint8_t(ring);
    }
    return rings;
  }

  std::uint32_t computed(std::uint32_t child_number) {
    std::uint32_t& index = computed_index_[child_number];
    if (index == Plan::none) {
      index = plan_.computed_vertices++;
      computed_source_.push_back(child_number);
    }
    return index;
  }

  void keep_faces(int rings_after) {
    computed_index_.assign(number_.count(), Plan::none);
    const std::vector<std::uint8_t> rings = child_rings(rings_after);
    const auto kept = std::size_t(std::ranges::count_if(rings, [](std::uint8_t r) { return r != unreached_ring; }));
    computed_source_.reserve(kept + kept / 4);
    plan_.corner_vertices.reserve(kept * corner_count());
    plan_.face_starts.reserve(kept + 1);
    plan_.face_parents.reserve(kept);
    plan_.face_child_index.reserve(kept);
    plan_.rings.reserve(kept);
    plan_.face_starts.push_back(0);
    const bool sharp = sharpness_.any_user_sharpness();
    for (int ring = 0; ring <= rings_after; ++ring)
      for (std::size_t c = 0; c < children_.size(); ++c) {
        if (rings[c] != ring) continue;
        const Child& child = children_[c];
        for (std::uint32_t k = 0; k < corner_count(); ++k) {
          plan_.corner_vertices.push_back(computed(child.corners[k]));
          if (sharp)
            plan_.corner_sharpness.push_back(
                child.edges[k] == Plan::none ? 0 : sharpness_.refined_edge(child.edges[k], child.vertex));
        }
        plan_.face_starts.push_back(std::uint32_t(plan_.corner_vertices.size()));
        plan_.face_parents.push_back(child.parent);
        plan_.face_child_index.push_back(child.index);
        plan_.rings.push_back(std::uint8_t(ring));
      }
    plan_.kept_vertices = plan_.computed_vertices;
    for (std::uint32_t n : computed_source_) {
      plan_.kinds.push_back(number_.kind(n));
      if (sharp)
        plan_.vertex_sharpness.push_back(
            number_.kind(n) == VertexKind::Vertex ? sharpness_.refined_vertex(number_.source(n)) : 0);
    }
  }

  void add_normal_faces() {
    plan_.corners_per_face = corner_count();
    plan_.normal_faces.reserve(plan_.corner_vertices.size() + plan_.corner_vertices.size() / 4);
    for (const Child& child : children_) {
      const bool touches_kept = std::any_of(child.corners, child.corners + corner_count(),
                                            [&](std::uint32_t n) { return computed_index_[n] < plan_.kept_vertices; });
      if (!touches_kept) continue;
      for (std::uint32_t k = 0; k < corner_count(); ++k) plan_.normal_faces.push_back(computed(child.corners[k]));
    }
    plan_.normal_face_counts.assign(plan_.computed_vertices, 0);
    for (std::uint32_t v : plan_.normal_faces) ++plan_.normal_face_counts[v];
  }

  void write_vertices() {
    for (std::uint32_t out = 0; out < plan_.computed_vertices; ++out) {
      const std::uint32_t n = computed_source_[out], source = number_.source(n);
      switch (number_.kind(n)) {
        case VertexKind::Face: plan_.face_vertices.push_back({source, out}); break;
        case VertexKind::Edge: write_edge(source, out); break;
        case VertexKind::Vertex: write_vertex(source, out); break;
      }
    }
  }

  std::uint32_t third_corner(std::uint32_t f, const Adjacency::Edge& edge) const {
    for (std::uint32_t v : mesh_.corners(f))
      if (v != edge.vertices[0] && v != edge.vertices[1]) return v;
    return Plan::none;
  }

  void write_edge(std::uint32_t e, std::uint32_t out) {
    const Adjacency::Edge& edge = adjacency_.edge(e);
    Plan::EdgeVertex vertex{{edge.vertices[0], edge.vertices[1]},
                            {edge.faces[0], edge.faces[1]},
                            {Plan::none, Plan::none},
                            sharpness_.edge_weight(e),
                            out};
    if (options_.scheme == Scheme::Loop && edge.faces[1] != Plan::none)
      for (int i = 0; i < 2; ++i) vertex.opposite[i] = third_corner(edge.faces[i], edge);
    plan_.edge_vertices.push_back(vertex);
  }

  void write_vertex(std::uint32_t v, std::uint32_t out) {
    const auto edges = adjacency_.edges_of_vertex(v);
    const auto faces = adjacency_.faces_of_vertex(v);
    Plan::VertexVertex vertex;
    vertex.vertex = v;
    vertex.out = out;
    vertex.first_neighbor = std::uint32_t(plan_.neighbors.size());
    vertex.neighbor_count = std::uint32_t(edges.size());
    vertex.first_face = std::uint32_t(plan_.vertex_faces.size());
    vertex.face_count = std::uint32_t(faces.size());
    for (std::uint32_t e : edges) plan_.neighbors.push_back(other_end(e, v));
    plan_.vertex_faces.insert(plan_.vertex_faces.end(), faces.begin(), faces.end());

    const VertexCrease crease = sharpness_.vertex_rule(v);
    vertex.rule = crease.rule;
    vertex.next_rule = crease.next_rule;
    vertex.weight = crease.weight;
    for (int i = 0; i < 2; ++i) {
      if (crease.edges[i] != Plan::none) vertex.ends[i] = other_end(crease.edges[i], v);
      if (crease.next_edges[i] != Plan::none) vertex.next_ends[i] = other_end(crease.next_edges[i], v);
    }
    plan_.vertex_vertices.push_back(vertex);
  }

  std::uint32_t other_end(std::uint32_t e, std::uint32_t v) const {
    const Adjacency::Edge& edge = adjacency_.edge(e);
    return edge.vertices[0] == v ? edge.vertices[1] : edge.vertices[0];
  }

  const Mesh& mesh_;
  const RefineOptions options_;
  const Adjacency adjacency_;
  const ChildNumbers number_;
  const CreaseSharpness sharpness_;
  std::vector<Child> children_;
  std::vector<std::uint32_t> computed_index_, computed_source_;
  Plan plan_;
};

template <class T>
std::size_t capacity_bytes(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

}  // namespace

std::size_t RefinePlan::bytes() const {
  return sizeof(*this) + capacity_bytes(face_starts) + capacity_bytes(corner_vertices) +
         capacity_bytes(corner_sharpness) + capacity_bytes(vertex_sharpness) + capacity_bytes(face_parents) +
         capacity_bytes(face_child_index) + capacity_bytes(rings) + capacity_bytes(kinds) +
         capacity_bytes(normal_faces) + capacity_bytes(normal_face_counts) + capacity_bytes(face_vertices) +
         capacity_bytes(edge_vertices) + capacity_bytes(vertex_vertices) + capacity_bytes(neighbors) +
         capacity_bytes(vertex_faces);
}

std::shared_ptr<const RefinePlan> make_refine_plan(const Mesh& mesh, std::uint32_t owned_faces, int rings_after,
                                                   const RefineOptions& options) {
  return std::make_shared<const RefinePlan>(PlanBuilder(mesh, owned_faces, rings_after, options).take());
}

namespace {

// A full set of levels of one quad patch is some 150 KB, so about 200 shapes stay.
PlanTable<RefinePlan>& plan_table() {
  static PlanTable<RefinePlan> table;
  return table;
}

}  // namespace

std::size_t refine_plan_bytes() { return plan_table().bytes(); }

void set_refine_plan_capacity(std::size_t bytes) { plan_table().set_capacity(bytes); }

std::shared_ptr<const RefinePlan> shared_refine_plan(const Mesh& mesh, std::uint32_t owned_faces, int rings_after,
                                                     const RefineOptions& options) {
  return plan_table().get(shape_name(mesh, owned_faces, std::uint64_t(rings_after) << 8 | options.bits()),
                          [&] { return make_refine_plan(mesh, owned_faces, rings_after, options); });
}

}  // namespace meristem
