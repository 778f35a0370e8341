#include "geometry/mesh/limit.h"

#include "tests/geometry/mesh/subdivision_cases.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <unordered_map>

namespace meristem {
namespace {

using namespace subdivision;

// A vertex of the last level as OpenSubdiv sees it.
struct LimitTruth {
  Vec3d position, along, normal;  // `along`: the first tangent
  Sdc::Crease::Rule rule;
  bool is_boundary;
};

std::vector<LimitTruth> opensubdiv_limits(const Mesh& mesh, int level, const RefineOptions& options) {
  const auto refiner = opensubdiv_refiner(mesh, level, options);
  const std::vector<Point> points = opensubdiv_points(mesh, *refiner);
  std::vector<Point> positions(points.size()), tangents1(points.size()), tangents2(points.size());
  Far::PrimvarRefinerReal<double>(*refiner).Limit(points, positions, tangents1, tangents2);
  std::vector<LimitTruth> limits;
  for (std::size_t i = 0; i < points.size(); ++i)
    limits.push_back({positions[i].p, normalize(tangents1[i].p), normalize(cross(tangents1[i].p, tangents2[i].p)),
                      refiner->GetLevel(level).GetVertexRule(int(i)),
                      refiner->GetLevel(level).IsVertexBoundary(int(i))});
  return limits;
}

LimitSurface limit_of(const Mesh& mesh, const RefineOptions& options) {
  return limit_surface(mesh, mesh.face_count(), options);
}

// A vertex within the surface holds one normal for all sides of a ridge; OpenSubdiv gives that of one side.
void expect_same_normal(Vec3d normal, const LimitTruth& truth) {
  const bool is_smooth = truth.rule == Sdc::Crease::RULE_SMOOTH || truth.rule == Sdc::Crease::RULE_DART;
  if (is_smooth || truth.is_boundary) {
    EXPECT_LT(length(normal - truth.normal), 1e-7);
  } else if (truth.rule == Sdc::Crease::RULE_CREASE) {
    EXPECT_NEAR(dot(normal, truth.along), 0, 1e-7);
    EXPECT_GT(dot(normal, truth.normal), 0.1);
  }
}

TEST(Limit, AgreesWithOpenSubdiv) {
  for (const Case& c : cases())
    for (int level = 1; level <= 3; ++level) {
      SCOPED_TRACE(fmt::format("{} at level {}", c.name, level));
      if (opensubdiv_extrapolates(*opensubdiv_refiner(c.mesh, level, c.options))) continue;
      const LimitSurface limit = limit_of(refined(c.mesh, level, c.options), c.options);
      const std::vector<LimitTruth> truths = opensubdiv_limits(c.mesh, level, c.options);
      ASSERT_EQ(limit.positions.size(), truths.size());
      for (std::size_t v = 0; v < truths.size(); ++v) {
        const Vec3d p = limit.positions[v];
        const auto truth =
            std::min_element(truths.begin(), truths.end(), [&](const LimitTruth& a, const LimitTruth& b) {
              return length_squared(a.position - p) < length_squared(b.position - p);
            });
        ASSERT_LT(length(truth->position - p), 1e-7);
        EXPECT_NEAR(length(limit.normals[v]), 1, 1e-12);
        expect_same_normal(limit.normals[v], *truth);
      }
    }
}

// Indices of vertices by key.
std::unordered_map<Key, std::uint32_t> vertices_by_key(const Mesh& mesh) {
  std::unordered_map<Key, std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) vertices.emplace(mesh.vertex_keys[v], v);
  return vertices;
}

// For every vertex of refined(mesh, from), what became of it in refined(mesh, to).
std::vector<std::uint32_t> descendants(const Mesh& coarse, int from, const Mesh& fine, int to) {
  const auto vertices = vertices_by_key(fine);
  std::vector<std::uint32_t> result;
  for (Key key : coarse.vertex_keys) {
    for (int l = from; l < to; ++l) key = hash_keys(key, refined_step_key(l) ^ 3);
    result.push_back(vertices.at(key));
  }
  return result;
}

// Whether the vertex is the end of a crease, for which the smooth mask is an approximation.
std::vector<bool> find_darts(const Mesh& mesh) {
  std::vector<int> sharp_corners(mesh.vertex_count(), 0);  // two for each edge, one on either side
  for (std::uint32_t f = 0; f < mesh.face_count() && !mesh.corner_sharpness.empty(); ++f) {
    const auto c = mesh.corners(f);
    for (std::size_t k = 0; k < c.size(); ++k)
      if (mesh.corner_sharpness[mesh.face_starts[f] + k] > 0) {
        ++sharp_corners[c[k]];
        ++sharp_corners[c[(k + 1) % c.size()]];
      }
  }
  std::vector<bool> darts;
  for (int count : sharp_corners) darts.push_back(count == 2);
  return darts;
}

TEST(Limit, LevelsShareOneSurface) {
  for (const Case& c : cases()) {
    const auto decays = [](float s) { return s > 0 && s < 10; };
    if (std::any_of(c.mesh.corner_sharpness.begin(), c.mesh.corner_sharpness.end(), decays)) continue;
    SCOPED_TRACE(c.name);
    const Mesh coarse = refined(c.mesh, 2, c.options), fine = refined(c.mesh, 3, c.options);
    const LimitSurface coarse_limit = limit_of(coarse, c.options), fine_limit = limit_of(fine, c.options);
    const std::vector<std::uint32_t> same = descendants(coarse, 2, fine, 3);
    const std::vector<bool> is_dart = find_darts(coarse);
    for (std::uint32_t v = 0; v < coarse.vertex_count(); ++v) {
      if (is_dart[v]) continue;
      EXPECT_LT(length(coarse_limit.positions[v] - fine_limit.positions[same[v]]), 1e-9);
      EXPECT_LT(length(coarse_limit.normals[v] - fine_limit.normals[same[v]]), 1e-7);
    }
  }
}

TEST(Limit, IsWhereDeepRefinementTends) {
  for (const Case& c : {cases()[0], cases()[3], cases()[4], cases()[6]}) {
    SCOPED_TRACE(c.name);
    const Mesh coarse = refined(c.mesh, 1, c.options), deep = refined(c.mesh, 6, c.options);
    const LimitSurface limit = limit_of(coarse, c.options);
    std::vector<Vec3d> normals(deep.vertex_count());
    for (std::uint32_t f = 0; f < deep.face_count(); ++f)
      for (std::uint32_t v : deep.corners(f)) normals[v] += newell_normal(deep, f);
    const std::vector<std::uint32_t> same = descendants(coarse, 1, deep, 6);
    for (std::uint32_t v = 0; v < coarse.vertex_count(); ++v) {
      EXPECT_LT(length(limit.positions[v] - deep.positions[same[v]]), 2e-3);
      EXPECT_LT(length(limit.normals[v] - normalize(normals[same[v]])), 0.03);
    }
  }
}

// The same mesh with its faces and vertices in another order.
Mesh reordered(const Mesh& mesh) {
  const auto by_key = [](const std::vector<Key>& keys) {
    std::vector<std::uint32_t> order(keys.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
    return order;
  };
  Mesh result;
  result.origins = mesh.origins;
  std::vector<std::uint32_t> index(mesh.vertex_count());
  for (std::uint32_t v : by_key(mesh.vertex_keys)) index[v] = result.add_vertex(mesh.positions[v], mesh.vertex_keys[v]);
  for (std::uint32_t f : by_key(mesh.face_keys)) {
    std::vector<std::uint32_t> corners;
    for (std::uint32_t c = mesh.face_starts[f]; c < mesh.face_starts[f + 1]; ++c) {
      corners.push_back(index[mesh.corner_vertices[c]]);
      if (!mesh.corner_sharpness.empty()) result.corner_sharpness.push_back(mesh.corner_sharpness[c]);
    }
    result.add_face(corners, mesh.face_keys[f], mesh.face_origins[f]);
  }
  return result;
}

TEST(Limit, BitsDoNotDependOnTheOrderOfTheMesh) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    Mesh mesh = refined(c.mesh, 3, c.options);
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)  // symmetric cages would hide what roundings do
      for (int i = 0; i < 3; ++i)
        mesh.positions[v][i] = Quantum::for_reach(16).round(mesh.positions[v][i] +
                                                            0.01 * uniform_double(hash_keys(mesh.vertex_keys[v], i)));
    const Mesh other = reordered(mesh);
    const LimitSurface limit = limit_of(mesh, c.options), other_limit = limit_of(other, c.options);
    const auto vertices = vertices_by_key(other);
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
      const std::uint32_t w = vertices.at(mesh.vertex_keys[v]);
      EXPECT_EQ(limit.positions[v], other_limit.positions[w]);
      EXPECT_EQ(limit.normals[v], other_limit.normals[w]);
    }
  }
}

TEST(Limit, OfAPlaneIsThePlane) {
  Mesh grid = shapes::bumpy_grid(4);
  for (Vec3d& p : grid.positions) p.y = 0;
  const LimitSurface limit = limit_of(refined(grid, 2, {}), {});
  for (std::size_t v = 0; v < limit.positions.size(); ++v) {
    EXPECT_EQ(limit.positions[v].y, 0);
    EXPECT_EQ(limit.normals[v], Vec3d(0, 1, 0));
    EXPECT_FALSE(std::signbit(limit.normals[v].x) || std::signbit(limit.normals[v].z));
  }
}

TEST(Limit, NormalsAtTheRidgesOfACreasedCube) {
  // Every edge sharp: the limit is the cube itself, and a ridge's normal lies half way between its sides.
  Mesh cube = shapes::cube();
  cube.corner_sharpness.assign(cube.corner_vertices.size(), 10);
  const LimitSurface limit = limit_of(refined(cube, 2, {}), {});
  for (std::size_t v = 0; v < limit.positions.size(); ++v) {
    Vec3d outwards;
    for (int i = 0; i < 3; ++i)
      if (std::abs(std::abs(limit.positions[v][i]) - 1) < 1e-9) outwards[i] = limit.positions[v][i];
    EXPECT_NE(outwards, Vec3d{});
    EXPECT_LT(length(limit.normals[v] - normalize(outwards)), 1e-9);
  }
}

TEST(Limit, ZeroForVerticesOfTheHaloAlone) {
  const Mesh mesh = refined(shapes::cube(), 2, {});
  const LimitSurface limit = limit_surface(mesh, 1, {});
  const auto owned = mesh.corners(0);
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
    EXPECT_EQ(limit.normals[v] != Vec3d{}, std::find(owned.begin(), owned.end(), v) != owned.end());
}

}  // namespace
}  // namespace meristem
