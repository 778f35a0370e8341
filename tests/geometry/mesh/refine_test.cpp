#include "geometry/mesh/refine.h"

#include "tests/geometry/mesh/subdivision_cases.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace meristem {
namespace {

using namespace subdivision;

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

TEST(Refine, AgreesWithOpenSubdiv) {
  int left_out = 0;
  for (const Case& c : cases())
    for (int level = 1; level <= 4; ++level) {
      SCOPED_TRACE(fmt::format("{} at level {}", c.name, level));
      const auto refiner = opensubdiv_refiner(c.mesh, level, c.options);
      if (opensubdiv_extrapolates(*refiner)) {
        ++left_out;
        continue;
      }
      std::vector<Vec3d> truth;
      for (const Point& point : opensubdiv_points(c.mesh, *refiner)) truth.push_back(point.p);
      expect_same_points(refined(c.mesh, level, c.options).positions, truth, 1e-7);
    }
  EXPECT_LT(left_out, 16);
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

// u, v lie over each face as its own corners say, whatever its neighbours do; positions are as without.
TEST(Refine, KeepsSeamsOfTextures) {
  for (const Scheme scheme : {Scheme::CatmullClark, Scheme::Loop}) {
    const bool is_loop = scheme == Scheme::Loop;
    Mesh mesh = is_loop ? shapes::tetrahedron() : shapes::prism(5);
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
      for (std::uint32_t k = 0; k < mesh.corner_count(f); ++k) {
        const double turn = 2 * pi * k / mesh.corner_count(f);
        mesh.corner_uv.push_back({f + 0.5 + 0.25 * std::cos(turn), std::sin(turn)});
      }
    Mesh averaged = mesh;
    ASSERT_TRUE(corners_differ(mesh));
    keep_seams(mesh);
    const Mesh out = refined(mesh, 3, {scheme});
    EXPECT_EQ(out.positions, refined(averaged, 3, {scheme}).positions);
    EXPECT_TRUE(refined(averaged, 3, {scheme}).corner_uv.empty());
    ASSERT_EQ(out.corner_uv.size(), out.corner_vertices.size());
    std::vector<double> areas(mesh.face_count(), 0);
    for (std::uint32_t f = 0; f < out.face_count(); ++f) {
      double area = 0;
      for (std::uint32_t k = 0; k < out.corner_count(f); ++k) {
        const Vec2d a = out.corner_uv[out.face_starts[f] + k],
                    b = out.corner_uv[out.face_starts[f] + (k + 1) % out.corner_count(f)];
        EXPECT_EQ(std::floor(a.x), std::floor(out.corner_uv[out.face_starts[f]].x));
        area += (a.x * b.y - a.y * b.x) / 2;
      }
      EXPECT_GT(area, 0) << "else it is a mirror image";
      areas.at(std::size_t(out.corner_uv[out.face_starts[f]].x)) += area;
    }
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {  // children fill their parent
      const double n = mesh.corner_count(f);
      EXPECT_NEAR(areas[f], n / 2 * 0.25 * std::sin(2 * pi / n), 1e-9);
    }
  }
}

TEST(Refine, CornersDifferAtSeamsAlone) {
  Mesh mesh = shapes::cube();
  for (const std::uint32_t v : mesh.corner_vertices) mesh.corner_uv.push_back({mesh.positions[v].x, 1});
  EXPECT_FALSE(corners_differ(mesh));
  EXPECT_TRUE(refined(mesh, 1, {}).corner_uv.empty());
  mesh.corner_uv[5].y = 0.5;
  EXPECT_TRUE(corners_differ(mesh));
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
