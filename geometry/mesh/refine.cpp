#include "geometry/mesh/refine.h"

#include "geometry/base/check.h"
#include "geometry/mesh/face_sums.h"

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

// What refinement interpolates, as one row of numbers so that loops run over all of them: x, y, z, u, v, and one to
// spare.
struct Row {
  double c[6] = {};

  Row& operator+=(const Row& b) {
    for (int i = 0; i < 6; ++i) c[i] += b.c[i];
    return *this;
  }
  Row operator*(double s) const {
    Row r;
    for (int i = 0; i < 6; ++i) r.c[i] = c[i] * s;
    return r;
  }
};

Row operator+(Row a, const Row& b) { return a += b; }

// Rounds every column to its grid.
class RowGrid {
 public:
  RowGrid(double position_step, double uv_step) {
    for (int i = 0; i < 6; ++i) magic_.c[i] = (i < 3 ? position_step : uv_step) * 0x1.8p52;
  }
  Row round(Row r) const {
    for (int i = 0; i < 6; ++i) r.c[i] = (r.c[i] + magic_.c[i]) - magic_.c[i];
    return r;
  }

 private:
  Row magic_;
};

// The scheme's vertex placement over one plan, into positions and u, v of all its computed vertices. Sums are exact
// (all terms on the grid); each result is rounded once.
class Smoothing {
 public:
  Smoothing(const Mesh& mesh, const RefinePlan& plan, const Quantum& quantum, RefinedMesh& out)
      : plan_(plan),
        grid_(quantum.step(), unit_quantum.step()),
        fine_grid_(quantum.step() / 16, unit_quantum.step() / 16),
        in_(mesh.vertex_count()),
        face_points_(plan.corners_per_face == 3 ? 0 : mesh.face_count()),
        positions_(out.positions.data()),
        uv_(out.uv.data()) {
    if (mesh.uv.empty())
      read(mesh, vertex_uv(mesh));
    else
      read(mesh, mesh.uv);
    const bool is_loop = plan.corners_per_face == 3;
    if (!is_loop) find_face_points(mesh);
    for (const auto& v : plan.face_vertices) put(v.out, face_points_[v.face]);
    for (const auto& v : plan.edge_vertices) put(v.out, is_loop ? loop_edge(v) : edge(v));
    for (const auto& v : plan.vertex_vertices) put(v.out, is_loop ? vertex<true>(v) : vertex<false>(v));
  }

 private:
  void read(const Mesh& mesh, const std::vector<Vec2d>& uv) {
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
      const Vec3d p = mesh.positions[v];
      in_[v] = {{p.x, p.y, p.z, uv[v].x, uv[v].y, 0}};
    }
  }

  void put(std::uint32_t vertex, const Row& exact) {
    const Row r = grid_.round(exact);
    positions_[vertex] = {r.c[0], r.c[1], r.c[2]};
    uv_[vertex] = {r.c[3], r.c[4]};
  }

  // Face points of quads are exact on a grid 4 times finer; others are rounded to one 16 times finer, so that their
  // sums stay exact.
  void find_face_points(const Mesh& mesh) {
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      Row sum;
      for (std::uint32_t v : mesh.corners(f)) sum += in_[v];
      face_points_[f] = fine_grid_.round(sum * (1.0 / mesh.corner_count(f)));
    }
  }

  static Row blend(const Row& smooth, const Row& sharp, double sharp_weight) {
    return sharp_weight == 0 ? smooth : sharp_weight == 1 ? sharp : smooth * (1 - sharp_weight) + sharp * sharp_weight;
  }

  // Catmull and Clark 1978: the mean of the ends and the two face points; on a crease the midpoint.
  Row edge(const RefinePlan::EdgeVertex& v) const {
    const Row ends = in_[v.ends[0]] + in_[v.ends[1]];
    if (v.crease == 1) return ends * 0.5;
    return blend((ends + face_points_[v.faces[0]] + face_points_[v.faces[1]]) * 0.25, ends * 0.5, v.crease);
  }

  // Loop 1987: 3/8 of the ends, 1/8 of the opposite vertices.
  Row loop_edge(const RefinePlan::EdgeVertex& v) const {
    const Row ends = in_[v.ends[0]] + in_[v.ends[1]];
    if (v.crease == 1) return ends * 0.5;
    return blend((ends * 3.0 + in_[v.opposite[0]] + in_[v.opposite[1]]) * 0.125, ends * 0.5, v.crease);
  }

  template <bool is_loop>
  Row by_rule(const RefinePlan::VertexVertex& v, RefinePlan::Rule rule, const std::uint32_t ends[2]) const {
    switch (rule) {
      case RefinePlan::Rule::Corner: return in_[v.vertex];
      case RefinePlan::Rule::Crease: return (in_[v.vertex] * 6.0 + in_[ends[0]] + in_[ends[1]]) * 0.125;
      case RefinePlan::Rule::Smooth: break;
    }
    return is_loop ? loop_smooth(v) : catmull_clark_smooth(v);
  }

  template <bool is_loop>
  Row vertex(const RefinePlan::VertexVertex& v) const {
    const Row row = by_rule<is_loop>(v, v.rule, v.ends);
    return v.weight == 1 ? row
                         : by_rule<is_loop>(v, v.next_rule, v.next_ends) * (1 - double(v.weight)) + row * v.weight;
  }

  Row neighbor_sum(const RefinePlan::VertexVertex& v) const {
    Row sum;
    for (std::uint32_t i = 0; i < v.neighbor_count; ++i) sum += in_[plan_.neighbors[v.first_neighbor + i]];
    return sum;
  }

  // (n - 2)/n of the vertex, 1/n^2 of each neighbour and of each face point.
  Row catmull_clark_smooth(const RefinePlan::VertexVertex& v) const {
    Row sum = neighbor_sum(v);
    for (std::uint32_t i = 0; i < v.face_count; ++i) sum += face_points_[plan_.vertex_faces[v.first_face + i]];
    const double n = v.neighbor_count;
    return (in_[v.vertex] * (n * (n - 2)) + sum) * (1 / (n * n));
  }

  // Loop 1987: beta = (5/8 - (3/8 + cos(2 pi/n)/4)^2)/n for each neighbour.
  Row loop_smooth(const RefinePlan::VertexVertex& v) const {
    const double n = v.neighbor_count;
    const double c = 0.375 + 0.25 * std::cos(2 * pi / n);
    const double beta = n == 6 ? 0.0625 : (0.625 - c * c) / n;
    return in_[v.vertex] * (1 - n * beta) + neighbor_sum(v) * beta;
  }

  const RefinePlan& plan_;
  const RowGrid grid_, fine_grid_;
  Scratch<Row> in_, face_points_;
  Vec3d* const positions_;
  Vec2d* const uv_;
};

std::vector<Key> refined_face_keys(const Mesh& mesh, const RefinePlan& plan, Key step_key) {
  std::vector<Key> keys(plan.face_parents.size());
  for (std::size_t f = 0; f < keys.size(); ++f)
    keys[f] = hash_keys(mesh.face_keys[plan.face_parents[f]], step_key + plan.face_child_index[f]);
  return keys;
}

std::vector<Key> refined_vertex_keys(const Mesh& mesh, const RefinePlan& plan, Key step_key) {
  std::vector<Key> keys(plan.kept_vertices);
  for (const auto& v : plan.face_vertices)
    if (v.out < plan.kept_vertices) keys[v.out] = hash_keys(mesh.face_keys[v.face], step_key ^ 1);
  for (const auto& v : plan.edge_vertices)
    if (v.out < plan.kept_vertices)
      keys[v.out] = hash_keys(hash_unordered(mesh.vertex_keys[v.ends[0]], mesh.vertex_keys[v.ends[1]]), step_key ^ 2);
  for (const auto& v : plan.vertex_vertices)
    if (v.out < plan.kept_vertices) keys[v.out] = hash_keys(mesh.vertex_keys[v.vertex], step_key ^ 3);
  return keys;
}

// Every refinement halves the scale, which varies smoothly over the surface.
std::vector<double> refined_nominal_scale(const Mesh& mesh, const RefinePlan& plan) {
  const std::vector<double>& in = mesh.nominal_scale;
  std::vector<double> out(in.empty() ? 0 : plan.kept_vertices);
  if (in.empty()) return out;
  auto set = [&](std::uint32_t v, double scale) {
    if (v < plan.kept_vertices) out[v] = scale;
  };
  for (const auto& v : plan.face_vertices) {
    double sum = 0;
    for (std::uint32_t c : mesh.corners(v.face)) sum += in[c];
    set(v.out, 0.5 * sum / mesh.corner_count(v.face));
  }
  for (const auto& v : plan.edge_vertices) set(v.out, 0.25 * (in[v.ends[0]] + in[v.ends[1]]));
  for (const auto& v : plan.vertex_vertices) set(v.out, 0.5 * in[v.vertex]);
  return out;
}

// A vertex on an edge whose ends are both frozen is shown at one of these, a vertex in a face all of whose corners are
// at one of these: so faces that are as fine as wanted stay whole, and both sides of an edge agree.
std::vector<FrozenVertex> refined_frozen(const Mesh& mesh, const RefinePlan& plan) {
  const std::vector<FrozenVertex>& in = mesh.frozen;
  std::vector<FrozenVertex> out(in.empty() ? 0 : plan.kept_vertices);
  if (in.empty()) return out;
  auto copy = [&](std::uint32_t from, std::uint32_t to) {
    out[to] = in[from];
    out[to].is_copy = true;
  };
  for (const auto& v : plan.face_vertices) {
    const auto corners = mesh.corners(v.face);
    if (v.out < plan.kept_vertices &&
        std::all_of(corners.begin(), corners.end(), [&](auto c) { return in[c].is_frozen; }))
      copy(done_face_place(mesh, v.face), v.out);
  }
  for (const auto& v : plan.edge_vertices)
    if (v.out < plan.kept_vertices && in[v.ends[0]].is_frozen && in[v.ends[1]].is_frozen)
      copy(done_edge_place(mesh, v.ends[0], v.ends[1]), v.out);
  for (const auto& v : plan.vertex_vertices)
    if (v.out < plan.kept_vertices) out[v.out] = in[v.vertex];
  return out;
}

// On the surface that was shown before: at the middle of an edge, and in a face on the diagonal by which it was cut
// (tessellation.h).
FadingVertex middle_of(const Mesh& mesh, std::uint32_t a, std::uint32_t b) {
  const FadingVertex &v = mesh.fading[a], &w = mesh.fading[b];
  return {std::max(v.share, w.share), (v.position + w.position) * 0.5f, normalize(v.normal + w.normal),
          (v.uv + w.uv) * 0.5f};
}

FadingVertex middle_of_face(const Mesh& mesh, std::span<const std::uint32_t> corners) {
  const std::size_t n = corners.size();
  FadingVertex middle = n == 4 ? middle_of(mesh, corners[1], corners[3]) : middle_of(mesh, corners[0], corners[n / 2]);
  for (std::uint32_t c : corners) middle.share = std::max(middle.share, mesh.fading[c].share);
  return middle;
}

std::vector<FadingVertex> refined_fading(const Mesh& mesh, const RefinePlan& plan) {
  std::vector<FadingVertex> out(mesh.fading.empty() ? 0 : plan.kept_vertices);
  if (out.empty()) return out;
  for (const auto& v : plan.face_vertices)
    if (v.out < plan.kept_vertices) out[v.out] = middle_of_face(mesh, mesh.corners(v.face));
  for (const auto& v : plan.edge_vertices)
    if (v.out < plan.kept_vertices) out[v.out] = middle_of(mesh, v.ends[0], v.ends[1]);
  for (const auto& v : plan.vertex_vertices)
    if (v.out < plan.kept_vertices) out[v.out] = mesh.fading[v.vertex];
  return out;
}

// u, v of the corners of one face, one level further: straight between its own corners, so that no other face is asked
// and seams stay; what is frozen is shown at its corner.
class RefinedCornerUv {
 public:
  explicit RefinedCornerUv(const Mesh& mesh) : mesh_(mesh) {}

  // Of the child's corners, as RefinePlan turns them.
  void add_child_of_quads(std::uint32_t face, std::uint32_t child, std::vector<Vec2d>& out) const {
    const std::uint32_t n = mesh_.corner_count(face), turn = n == 4 ? child : 0;
    const Vec2d ring[4] = {corner(face, child), edge(face, child), middle(face), edge(face, (child + n - 1) % n)};
    for (std::uint32_t k = 0; k < 4; ++k) out.push_back(ring[(k + 4 - turn) % 4]);
  }
  void add_child_of_triangles(std::uint32_t face, std::uint32_t child, std::vector<Vec2d>& out) const {
    switch (child) {
      case 0: out.insert(out.end(), {corner(face, 0), edge(face, 0), edge(face, 2)}); break;
      case 1: out.insert(out.end(), {edge(face, 0), corner(face, 1), edge(face, 1)}); break;
      case 2: out.insert(out.end(), {edge(face, 2), edge(face, 1), corner(face, 2)}); break;
      default: out.insert(out.end(), {edge(face, 0), edge(face, 1), edge(face, 2)});
    }
  }

 private:
  Vec2d corner(std::uint32_t face, std::uint32_t k) const { return mesh_.corner_uv[mesh_.face_starts[face] + k]; }
  bool is_frozen(std::uint32_t vertex) const { return !mesh_.frozen.empty() && mesh_.frozen[vertex].is_frozen; }
  static Vec2d rounded(Vec2d uv) { return {unit_quantum.round(uv.x), unit_quantum.round(uv.y)}; }

  // On the edge from corner k on.
  Vec2d edge(std::uint32_t face, std::uint32_t k) const {
    const auto corners = mesh_.corners(face);
    const std::uint32_t next = k + 1 < corners.size() ? k + 1 : 0, a = corners[k], b = corners[next];
    if (is_frozen(a) && is_frozen(b)) return corner(face, done_edge_place(mesh_, a, b) == a ? k : next);
    return rounded((corner(face, k) + corner(face, next)) * 0.5);
  }
  Vec2d middle(std::uint32_t face) const {
    const auto corners = mesh_.corners(face);
    if (std::ranges::all_of(corners, [&](std::uint32_t v) { return is_frozen(v); }))
      return corner(face, std::uint32_t(std::ranges::find(corners, done_face_place(mesh_, face)) - corners.begin()));
    Vec2d sum;
    for (std::uint32_t k = 0; k < corners.size(); ++k) sum = sum + corner(face, k);
    return rounded(sum * (1.0 / double(corners.size())));
  }

  const Mesh& mesh_;
};

std::vector<Vec2d> refined_corner_uv(const Mesh& mesh, const RefinePlan& plan) {
  std::vector<Vec2d> out;
  if (!has_seams(mesh)) return out;
  out.reserve(plan.corner_vertices.size());
  const RefinedCornerUv refined(mesh);
  for (std::size_t f = 0; f < plan.face_parents.size(); ++f)
    if (plan.corners_per_face == 3)
      refined.add_child_of_triangles(plan.face_parents[f], plan.face_child_index[f], out);
    else
      refined.add_child_of_quads(plan.face_parents[f], plan.face_child_index[f], out);
  return out;
}

double mean_edge(std::span<const Vec3d> p, const std::uint32_t* c) {
  return (length(p[c[1]] - p[c[0]]) + length(p[c[2]] - p[c[1]]) + length(p[c[0]] - p[c[2]])) / 3;
}

void add_triangles(std::span<const Vec3d> positions, std::span<const std::uint32_t> corners, const Quantum& quantum,
                   std::span<FaceSum> sums) {
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const Vec3d normal = unit_face_normal(positions, &corners[i], 3);
    const double diagonal = quantum.round(mean_edge(positions, &corners[i]));
    for (std::size_t k = 0; k < 3; ++k) {
      sums[corners[i + k]].normal += normal;
      sums[corners[i + k]].diagonal += diagonal;
    }
  }
}

// The direction of growing u over a face: the gradient of P with respect to u, by least squares over two edges; zero if
// u, v do not vary.
Vec3d face_tangent(const RefinedMesh& m, const std::uint32_t* c, std::uint32_t count) {
  const Vec3d p1 = m.positions[c[1]] - m.positions[c[0]], p2 = m.positions[c[count - 1]] - m.positions[c[0]];
  const Vec2d t1 = m.uv[c[1]] - m.uv[c[0]], t2 = m.uv[c[count - 1]] - m.uv[c[0]];
  const double determinant = t1.x * t2.y - t1.y * t2.x;
  const Vec3d tangent = determinant != 0 ? (p1 * t2.y - p2 * t1.y) / determinant : p1 * t1.x + p2 * t2.x;
  return unit_quantum.round(normalize(tangent));
}

Vec3d tangent_in_plane(Vec3d sum, Vec3d normal) {
  const Vec3d t = normalize(sum - normal * dot(sum, normal));
  if (t != Vec3d{}) return t;
  Vec3d s, unused;
  orthonormal_basis(normal, s, unused);
  return s;
}

}  // namespace

std::uint32_t done_edge_place(const Mesh& mesh, std::uint32_t a, std::uint32_t b) {
  return mesh.vertex_keys[a] < mesh.vertex_keys[b] ? a : b;
}

std::uint32_t done_face_place(const Mesh& mesh, std::uint32_t face) {
  const auto corners = mesh.corners(face);
  if (corners.size() == 4) return done_edge_place(mesh, corners[1], corners[3]);
  return *std::ranges::min_element(corners, {}, [&](std::uint32_t v) { return mesh.vertex_keys[v]; });
}

std::vector<Vec2d> vertex_uv(const Mesh& mesh) {
  if (!mesh.uv.empty()) return mesh.uv;
  std::vector<Vec2d> uv(mesh.vertex_count());
  if (mesh.corner_uv.empty()) return uv;
  std::vector<std::uint32_t> count(mesh.vertex_count(), 0);
  for (std::size_t c = 0; c < mesh.corner_vertices.size(); ++c) {
    const std::uint32_t v = mesh.corner_vertices[c];
    uv[v] = uv[v] + Vec2d{unit_quantum.round(mesh.corner_uv[c].x), unit_quantum.round(mesh.corner_uv[c].y)};
    ++count[v];
  }
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
    if (count[v]) uv[v] = {unit_quantum.round(uv[v].x / count[v]), unit_quantum.round(uv[v].y / count[v])};
  return uv;
}

bool corners_differ(const Mesh& mesh) {
  std::vector<const Vec2d*> first(mesh.vertex_count(), nullptr);
  for (std::size_t c = 0; c < mesh.corner_uv.size(); ++c) {
    const Vec2d*& known = first[mesh.corner_vertices[c]];
    if (!known) known = &mesh.corner_uv[c];
    if (*known != mesh.corner_uv[c]) return true;
  }
  return false;
}

void keep_seams(Mesh& mesh) {
  mesh.uv = vertex_uv(mesh);
  for (Vec2d& uv : mesh.corner_uv) uv = {unit_quantum.round(uv.x), unit_quantum.round(uv.y)};
  mesh.seam_widths.clear();
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) mesh.seam_widths.push_back(seam_width(mesh, f));
}

Vec2f seam_width(const Mesh& mesh, std::uint32_t face) {
  Vec2d low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  for (std::uint32_t c = mesh.face_starts[face]; c < mesh.face_starts[face + 1]; ++c) {
    const Vec2d uv = mesh.corner_uv[c];
    low = {std::min(low.x, uv.x), std::min(low.y, uv.y)};
    high = {std::max(high.x, uv.x), std::max(high.y, uv.y)};
  }
  // Twice, since parts of what is no parallelogram may be wider than half of it
  return {float(2 * (high.x - low.x)), float(2 * (high.y - low.y))};
}

Vec3d unit_face_normal(std::span<const Vec3d> positions, const std::uint32_t* corners, std::uint32_t count) {
  if (count == 4)
    return unit_quantum.round(
        normalize(cross(positions[corners[2]] - positions[corners[0]], positions[corners[3]] - positions[corners[1]])));
  const Vec3d origin = positions[corners[0]];
  Vec3d normal;
  for (std::uint32_t i = 1; i + 1 < count; ++i)
    normal += cross(positions[corners[i]] - origin, positions[corners[i + 1]] - origin);
  return unit_quantum.round(normalize(normal));
}

RefinedMesh refine(const Mesh& mesh, const RefinePlan& plan, const Quantum& quantum, Key step_key) {
  RefinedMesh refined(plan.computed_vertices);
  Smoothing(mesh, plan, quantum, refined);
  Mesh& out = refined.mesh;
  out.face_starts = plan.face_starts;
  out.corner_vertices = plan.corner_vertices;
  out.corner_sharpness = plan.corner_sharpness;
  out.vertex_sharpness = plan.vertex_sharpness;
  out.positions.assign(refined.positions.data(), refined.positions.data() + plan.kept_vertices);
  out.uv.assign(refined.uv.data(), refined.uv.data() + plan.kept_vertices);
  out.corner_uv = refined_corner_uv(mesh, plan);
  if (has_seams(mesh))
    for (std::uint32_t parent : plan.face_parents) out.seam_widths.push_back(mesh.seam_widths[parent] * 0.5f);
  out.face_keys = refined_face_keys(mesh, plan, step_key);
  out.vertex_keys = refined_vertex_keys(mesh, plan, step_key);
  out.nominal_scale = refined_nominal_scale(mesh, plan);
  out.frozen = refined_frozen(mesh, plan);
  out.fading = refined_fading(mesh, plan);
  out.origins = mesh.origins;
  out.face_origins.reserve(plan.face_parents.size());
  for (std::uint32_t parent : plan.face_parents) out.face_origins.push_back(mesh.face_origins[parent]);
  if (!mesh.enlargements.empty())
    for (std::uint32_t parent : plan.face_parents) out.enlargements.push_back(mesh.enlargements[parent]);
  return refined;
}

LocalGeometry local_geometry(const RefinePlan& plan, const RefinedMesh& refined, const Quantum& quantum,
                             bool with_tangents) {
  // Sums run over all computed vertices (those beyond the kept ones come out incomplete and are dropped).
  Scratch<FaceSum> sums(plan.computed_vertices, FaceSum{});
  const std::span<const Vec3d> positions = refined.positions.span();
  const std::uint32_t n = plan.corners_per_face;
  if (n == 4)
    add_quads(positions, plan.normal_faces, quantum, sums.span());
  else
    add_triangles(positions, plan.normal_faces, quantum, sums.span());

  LocalGeometry local(plan.kept_vertices, with_tangents);
  unit_normals(sums.span().first(plan.kept_vertices), local.normals.data());
  for (std::uint32_t v = 0; v < plan.kept_vertices; ++v)
    local.scales[v] = sums[v].diagonal / std::max<std::uint16_t>(1, plan.normal_face_counts[v]);
  if (!with_tangents) return local;

  Scratch<Vec3d> tangents(plan.computed_vertices, Vec3d{});
  for (std::size_t i = 0; i < plan.normal_faces.size(); i += n) {
    const std::uint32_t* corners = &plan.normal_faces[i];
    const Vec3d tangent = face_tangent(refined, corners, n);
    for (std::uint32_t k = 0; k < n; ++k) tangents[corners[k]] += tangent;
  }
  for (std::uint32_t v = 0; v < plan.kept_vertices; ++v)
    local.tangents[v] = tangent_in_plane(tangents[v], local.normals[v]);
  return local;
}

}  // namespace meristem
