#include "geometry/mesh/refine.h"

#include "tests/support/shapes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include <algorithm>
#include <memory>

namespace meristem {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

struct Point {
  Vec3d p;
  void Clear(void* = nullptr) { p = {}; }
  void AddWithWeight(const Point& b, double w) { p += b.p * w; }
};

// OpenSubdiv's own refinement of the cage to a level: all its vertices.
std::vector<Vec3d> opensubdiv_positions(const Mesh& mesh, int level, const RefineOptions& options) {
  Sdc::Options sdc;
  sdc.SetVtxBoundaryInterpolation(options.boundary == BoundaryRule::EdgeOnly
                                      ? Sdc::Options::VTX_BOUNDARY_EDGE_ONLY
                                      : Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
  std::vector<int> counts, indices, crease_pairs;
  std::vector<float> crease_weights;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto c = mesh.corners(f);
    counts.push_back(int(c.size()));
    indices.insert(indices.end(), c.begin(), c.end());
    for (std::uint32_t k = 0; k < c.size() && !mesh.corner_sharpness.empty(); ++k)
      if (const float s = mesh.corner_sharpness[mesh.face_starts[f] + k]; s > 0) {
        crease_pairs.push_back(int(c[k]));
        crease_pairs.push_back(int(c[(k + 1) % c.size()]));
        crease_weights.push_back(s);
      }
  }
  Far::TopologyDescriptor descriptor;
  descriptor.numVertices = int(mesh.vertex_count());
  descriptor.numFaces = int(mesh.face_count());
  descriptor.numVertsPerFace = counts.data();
  descriptor.vertIndicesPerFace = indices.data();
  descriptor.numCreases = int(crease_weights.size());
  descriptor.creaseVertexIndexPairs = crease_pairs.data();
  descriptor.creaseWeights = crease_weights.data();
  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  const auto type = options.scheme == Scheme::Loop ? Sdc::SCHEME_LOOP : Sdc::SCHEME_CATMARK;
  const std::unique_ptr<Far::TopologyRefiner> refiner(Factory::Create(descriptor, Factory::Options(type, sdc)));
  refiner->RefineUniform(Far::TopologyRefiner::UniformOptions(level));
  std::vector<Point> points(mesh.vertex_count());
  for (std::size_t i = 0; i < points.size(); ++i) points[i].p = mesh.positions[i];
  for (int l = 1; l <= level; ++l) {
    std::vector<Point> next(std::size_t(refiner->GetLevel(l).GetNumVertices()));
    Far::PrimvarRefinerReal<double>(*refiner).Interpolate(l, points, next);
    points = std::move(next);
  }
  std::vector<Vec3d> result;
  for (const Point& p : points) result.push_back(p.p);
  return result;
}

Mesh refined(Mesh mesh, int level, const RefineOptions& options) {
  const Quantum quantum = Quantum::for_reach(16);
  for (Vec3d& p : mesh.positions) p = quantum.round(p);
  for (int l = 0; l < level; ++l) {
    const auto plan = make_refine_plan(mesh, mesh.face_count(), 0, options);
    mesh = refine(mesh, *plan, quantum, hash_keys(9, l)).mesh;
  }
  return mesh;
}

// Both lists hold the same points, in whatever order: nearest neighbours by brute force on a sorted axis.
void expect_same_points(std::vector<Vec3d> a, std::vector<Vec3d> b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  const auto by_x = [](Vec3d p, Vec3d q) { return p.x < q.x; };
  std::sort(b.begin(), b.end(), by_x);
  for (Vec3d p : a) {
    double nearest = 1e9;
    for (auto q = std::lower_bound(b.begin(), b.end(), p - Vec3d{tolerance, 0, 0}, by_x);
         q != b.end() && q->x <= p.x + tolerance; ++q)
      nearest = std::min(nearest, length(*q - p));
    ASSERT_LE(nearest, tolerance);
  }
}

struct Case {
  const char* name;
  Mesh mesh;
  RefineOptions options;
};

std::vector<Case> cases() {
  const RefineOptions loop{Scheme::Loop, BoundaryRule::EdgeAndCorner},
      edge_only{Scheme::CatmullClark, BoundaryRule::EdgeOnly};
  std::vector<Case> all{{"cube", shapes::cube(), {}},
                        {"tetrahedron", shapes::tetrahedron(), {}},
                        {"octagonal prism", shapes::prism(8), {}},
                        {"triangular prism", shapes::prism(3), {}},
                        {"open grid", shapes::bumpy_grid(4), {}},
                        {"open grid, corners rounded", shapes::bumpy_grid(4), edge_only},
                        {"Loop icosahedron", shapes::icosahedron(), loop},
                        {"Loop tetrahedron", shapes::tetrahedron(), loop}};
  for (float sharpness : {0.3f, 1.0f, 1.7f, 2.5f, 10.0f}) {
    Mesh ring = shapes::cube();
    for (auto [a, b] : {std::pair{0, 1}, {1, 3}, {3, 2}, {2, 0}})
      shapes::crease(ring, std::uint32_t(a), std::uint32_t(b), sharpness);
    all.push_back({"cube with a creased face", ring, {}});
    Mesh dart = shapes::cube();
    shapes::crease(dart, 0, 1, sharpness);
    all.push_back({"cube with one creased edge", dart, {}});
    Mesh mixed = shapes::prism(5);
    shapes::crease(mixed, 5, 6, sharpness);
    shapes::crease(mixed, 6, 7, sharpness / 2);
    shapes::crease(mixed, 1, 6, 1.2f);
    all.push_back({"prism with mixed creases", mixed, {}});
    Mesh triangles = shapes::icosahedron();
    shapes::crease(triangles, 0, 11, sharpness);
    shapes::crease(triangles, 11, 10, sharpness);
    all.push_back({"creased Loop icosahedron", triangles, loop});
  }
  return all;
}

TEST(Refine, AgreesWithOpenSubdiv) {
  for (const Case& c : cases())
    for (int level = 1; level <= 4; ++level) {
      SCOPED_TRACE(fmt::format("{} at level {}", c.name, level));
      expect_same_points(refined(c.mesh, level, c.options).positions, opensubdiv_positions(c.mesh, level, c.options),
                         1e-7);
    }
}

TEST(Refine, KeepsClosedMeshesClosedAndManifold) {
  for (const Case& c : cases()) {
    const Mesh mesh = refined(c.mesh, 3, c.options);
    EXPECT_EQ(manifold_defect(mesh), "") << c.name;
    EXPECT_EQ(is_closed(mesh), is_closed(c.mesh)) << c.name;
  }
}

TEST(Refine, CountsOfACube) {
  const Mesh mesh = refined(shapes::cube(), 3, {});
  EXPECT_EQ(mesh.face_count(), 6u * 64);
  EXPECT_EQ(mesh.vertex_count(), 6u * 64 + 2);  // Euler: V - E + F = 2 with E = 2 F
}

TEST(Refine, KeysAreUnique) {
  Mesh mesh = refined(shapes::prism(8), 4, {});
  std::sort(mesh.vertex_keys.begin(), mesh.vertex_keys.end());
  EXPECT_EQ(std::adjacent_find(mesh.vertex_keys.begin(), mesh.vertex_keys.end()), mesh.vertex_keys.end());
  std::sort(mesh.face_keys.begin(), mesh.face_keys.end());
  EXPECT_EQ(std::adjacent_find(mesh.face_keys.begin(), mesh.face_keys.end()), mesh.face_keys.end());
}

TEST(Refine, AveragesCornerUvAtSharedVertices) {
  // Two quads side by side give the two vertices between them different u: figure 9's 0 and 0.5 average to 0.25.
  Mesh mesh = shapes::from_faces({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}},
                                 {{0, 1, 2, 3}, {1, 4, 5, 2}});
  mesh.corner_uv = {{0, 0}, {0, 0}, {0.5, 1}, {0, 1}, {0.5, 0}, {1, 0}, {1, 1}, {1, 1}};
  const std::vector<Vec2d> uv = vertex_uv(mesh);
  EXPECT_EQ(uv[0].x, 0);
  EXPECT_EQ(uv[1].x, 0.25);
  EXPECT_EQ(uv[2].x, 0.75);
  EXPECT_EQ(uv[4].x, 1);
}

TEST(LocalGeometry, OfACube) {
  const Mesh cube = shapes::cube();
  const auto plan = make_refine_plan(cube, 6, 0, {});
  const RefinedMesh r = refine(cube, *plan, Quantum::for_reach(2), 1);
  const LocalGeometry local = local_geometry(*plan, r, Quantum::for_reach(2), true);
  for (std::uint32_t v = 0; v < plan->kept_vertices; ++v) {
    EXPECT_NEAR(length(local.normals[v]), 1, 1e-12);
    EXPECT_GT(dot(local.normals[v], r.mesh.positions[v]), 0.9);  // by symmetry every normal is radial
    EXPECT_NEAR(dot(local.normals[v], local.tangents[v]), 0, 1e-12);
    if (plan->kinds[v] == VertexKind::Face) {
      EXPECT_NEAR(dot(local.normals[v], r.mesh.positions[v]), 1, 1e-9);
      // The face point has four faces alike: corner (5/9, 5/9, 5/9), edge points (3/4, 3/4, 0), face point (0, 0, 1).
      const double d1 = length(Vec3d{5.0 / 9, 5.0 / 9, 5.0 / 9} - Vec3d{0, 0, 1}),
                   d2 = length(Vec3d{0.75, 0, 0.75} - Vec3d{0, 0.75, 0.75});
      EXPECT_NEAR(local.scales[v], (d1 + d2) / 2, 1e-9);
    }
  }
}

}  // namespace
}  // namespace meristem
