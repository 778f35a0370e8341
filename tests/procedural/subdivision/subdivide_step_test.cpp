// Subdivision as a scene asks for it, cell by cell: the same bits for any cut, and OpenSubdiv's surface where
// boundaries are not interpolated.
#include "procedural/subdivision/subdivide_step.h"

#include "procedural/subdivision/drop_border_step.h"
#include "procedural/subdivision/subdivide.h"
#include "tests/geometry/mesh/subdivision_cases.h"
#include "tests/procedural/growth/derivation.h"
#include "tests/support/leaf_quads.h"
#include "tests/support/point_footprint.h"
#include "tests/support/shown_corners.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <set>

namespace meristem {
namespace {

using namespace subdivision;

constexpr int never = 0;

// The border is dropped before the level `dropped_before`, counted from 1.
std::shared_ptr<const Model> subdivided(Mesh base, int levels, int dropped_before, const RefineOptions& options,
                                        const std::string& place, CellSettings settings) {
  std::vector<std::unique_ptr<Step>> steps;
  const auto expression = place.empty() ? nullptr : Expression::compile(place, placement_symbols(), ValueType::Vector);
  for (int level = 1; level <= levels; ++level) {
    if (level == dropped_before) steps.push_back(std::make_unique<DropBorderStep>());
    steps.push_back(std::make_unique<SubdivideStep>(
        SubdivideStep::Settings{options, expression, level, refined_step_key(level), Quantum()}));
  }
  return std::make_shared<const Model>("test", std::move(base), std::move(steps), settings);
}

constexpr CellSettings whole{1u << 20, 1u << 20};

// Creases of all kinds across an open grid, so that cells are cut through them.
Mesh creased_grid(std::uint32_t n) {
  Mesh mesh = shapes::bumpy_grid(n);
  const auto vertex = [&](std::uint32_t i, std::uint32_t j) { return j * (n + 1) + i; };
  constexpr float row[] = {0.4f, 2.7f, 1.3f, 0.9f, 4.1f, 10};
  for (std::uint32_t i = 0; i < n; ++i) {
    shapes::crease(mesh, vertex(i, 2), vertex(i + 1, 2), row[i % 6]);
    shapes::crease(mesh, vertex(3, i), vertex(3, i + 1), row[(i + 2) % 6]);
    if (i > 1) shapes::crease(mesh, vertex(i, 4), vertex(i, 3), 0.7f);
  }
  return mesh;
}

// Every edge of another sharpness: by Chaikin's rule each depends on those around it.
Mesh sharp_grid(std::uint32_t n) {
  Mesh mesh = shapes::bumpy_grid(n);
  const auto sharpness = [&](std::uint32_t v, Key direction) {
    return float(6 * uniform_double(hash_keys(v, direction)));
  };
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) {
      const std::uint32_t v = j * (n + 1) + i;
      if (i < n) shapes::crease(mesh, v, v + 1, sharpness(v, 1));
      if (j < n) shapes::crease(mesh, v, v + n + 1, sharpness(v, 2));
    }
  return mesh;
}

// A grid with one face missing: a border of faces in the middle, and holes that touch each other.
Mesh grid_with_a_gap(std::uint32_t n) {
  const Mesh grid = shapes::bumpy_grid(n);
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t f = 0; f < grid.face_count(); ++f) {
    const auto c = grid.corners(f);
    if (f != (n / 2) * n + n / 2) faces.emplace_back(c.begin(), c.end());
  }
  return shapes::from_faces(grid.positions, faces);
}

std::vector<std::string> names_of(const std::string& json, std::optional<RefineOptions>& options) {
  const Value value = test::JsonText(json).read();
  Diagnostics diagnostics;
  Params params(value, "step", diagnostics);
  std::vector<std::string> names;
  for (const auto& step : read_subdivide(params, 3, 0)) {
    names.push_back(step->name());
    options = step->refinement();
  }
  params.finish();
  EXPECT_TRUE(diagnostics.list().empty());
  return names;
}

TEST(Subdivide, ReadsBordersAndCreases) {
  using Names = std::vector<std::string>;
  std::optional<RefineOptions> options;
  EXPECT_EQ(names_of(R"json({ "subdivide": 2 })json", options), (Names{"subdivide 3", "subdivide 4"}));
  EXPECT_EQ(options, RefineOptions{});
  EXPECT_EQ(names_of(R"json({ "subdivide": 2, "boundary": "none", "creasing": "chaikin" })json", options),
            (Names{"drop border", "subdivide 3", "subdivide 4"}));
  EXPECT_EQ(options, (RefineOptions{Scheme::CatmullClark, BoundaryRule::EdgeOnly, Creasing::Chaikin}));
  EXPECT_EQ(names_of(R"json({ "subdivide": 0, "boundary": "none" })json", options), Names{});
}

TEST(Subdivide, SurfaceDoesNotDependOnTheCut) {
  const RefineOptions chaikin{Scheme::CatmullClark, BoundaryRule::EdgeOnly, Creasing::Chaikin};
  struct {
    const char* name;
    Mesh mesh;
    int dropped_before;
    RefineOptions options;
  } cases[] = {{"chaikin", creased_grid(6), never, chaikin},
               {"chaikin everywhere", sharp_grid(9), never, chaikin},
               {"uniform", creased_grid(6), never, {}},
               {"no border", creased_grid(6), 1, chaikin},
               {"no border around a gap", grid_with_a_gap(9), 1, {}},
               {"no border, from the third level on", grid_with_a_gap(9), 3, {}}};
  for (const auto& c : cases)
    for (const char* place : {"", "0.1*scale*(T + B*noise(P))", "0.3*scale*N*hash(N, P)"}) {
      SCOPED_TRACE(std::string(c.name) + ", placed by " + place);
      const auto expected = quads_of(leaves_of(*subdivided(c.mesh, 4, c.dropped_before, c.options, place, whole)));
      EXPECT_GT(expected.size(), 1000u);
      for (const CellSettings settings : {CellSettings{4, 16}, CellSettings{256, 4}}) {
        int cells = 0;
        const auto cut =
            quads_of(leaves_of(*subdivided(c.mesh, 4, c.dropped_before, c.options, place, settings), &cells));
        EXPECT_GT(cells, 1);
        EXPECT_TRUE(cut == expected) << "leaves of " << settings.leaf_faces;
      }
    }
}

TEST(Subdivide, BoundsContainWhatIsLeft) {
  for (int dropped_before : {1, 2, 3})
    for (const char* place : {"", "0.4*scale*N*(2*rand() - 1)"})
      for (const CellSettings settings : {CellSettings{4, 16}, CellSettings{16, 64}}) {
        const auto model = subdivided(grid_with_a_gap(9), 4, dropped_before, {}, place, settings);
        int cells = 0;
        EXPECT_EQ(count_outside(*model, root_cell(*model), 0, model_bounds(*model), cells), 0);
      }
}

// Beyond what floats can be traced with is as good as nowhere.
TEST(Subdivide, AModelThatCouldReachAnywhereIsRefused) {
  for (const char* place : {"N*1e30/scale", "N*exp(P[0])^99*1e38"})
    EXPECT_THROW(subdivided(shapes::bumpy_grid(3), 3, never, {}, place, whole), std::runtime_error) << place;
  EXPECT_NO_THROW(subdivided(shapes::bumpy_grid(3), 3, never, {}, "N*clamp(1e30/scale, 0, 9)", whole));
}

// However little is wanted, nothing is shown of a mesh whose border is still there.
TEST(Subdivide, CoarseSurfacesHaveNoBorderEither) {
  const ConstantFootprint coarse(100);
  for (const CellSettings settings : {whole, CellSettings{4, 16}}) {
    const auto model = subdivided(shapes::bumpy_grid(5), 4, 1, {}, "", settings);
    std::vector<Tessellation> leaves;
    int cells = 0;
    collect_leaves(*model, root_cell(*model, &coarse), 0, leaves, cells);
    Bounds3f bounds;
    std::size_t faces = 0;
    for (const Tessellation& t : leaves) {
      bounds.extend(t.bounds());
      faces += t.face_count;
    }
    EXPECT_EQ(faces, 9u);
    EXPECT_GT(bounds.lower.x, 0.9f);
    EXPECT_LT(bounds.upper.x, 4.1f);
  }
}

// The owned mesh after all steps, with the halo that a model carries along.
CellMesh carried(const Model& model) {
  CellMesh cell = root_cell(model);
  for (int level = 0; level < model.levels(); ++level) {
    CellMesh next;
    model.step(level).apply(cell, model.halo_rings(level + 1), next);
    cell = std::move(next);
  }
  return cell;
}

std::unique_ptr<Far::TopologyRefiner> refiner_without_border(const Mesh& mesh, int level,
                                                             const RefineOptions& options) {
  return opensubdiv_refiner(mesh, level, options, Sdc::Options::VTX_BOUNDARY_NONE);
}

// For every vertex of a face that is not a hole, that there is one of ours there, and as many on both sides.
void expect_same_points(const std::set<int>& vertices, const std::vector<Point>& truth,
                        const std::vector<Vec3d>& ours) {
  EXPECT_EQ(ours.size(), vertices.size());
  for (int v : vertices) {
    double nearest = 1e9;
    for (Vec3d p : ours) nearest = std::min(nearest, length(p - truth[std::size_t(v)].p));
    EXPECT_LT(nearest, 1e-6);
  }
}

std::set<int> shown_vertices(const Far::TopologyLevel& level, int& faces) {
  std::set<int> vertices;
  for (int f = 0; f < level.GetNumFaces(); ++f) {
    if (level.IsFaceHole(f)) continue;
    ++faces;
    for (int v : level.GetFaceVertices(f)) vertices.insert(v);
  }
  return vertices;
}

Mesh triangles_of(const Mesh& quads) {
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t f = 0; f < quads.face_count(); ++f) {
    const auto c = quads.corners(f);
    faces.push_back({c[0], c[1], c[2]});
    faces.push_back({c[0], c[2], c[3]});
  }
  return shapes::from_faces(quads.positions, faces);
}

TEST(Subdivide, WithoutBordersShowsWhatOpenSubdivDoes) {
  const RefineOptions catmull_clark{Scheme::CatmullClark, BoundaryRule::EdgeOnly, {}},
      chaikin{Scheme::CatmullClark, BoundaryRule::EdgeOnly, Creasing::Chaikin},
      loop{Scheme::Loop, BoundaryRule::EdgeOnly, {}};
  struct {
    const char* name;
    Mesh mesh;
    RefineOptions options;
  } cases[] = {
      {"grid", shapes::bumpy_grid(5), catmull_clark},      {"one face left", shapes::bumpy_grid(3), catmull_clark},
      {"gap", grid_with_a_gap(9), catmull_clark},          {"creases", creased_grid(6), chaikin},
      {"Loop", triangles_of(shapes::bumpy_grid(5)), loop}, {"closed", shapes::prism(5), catmull_clark}};
  for (const auto& c : cases)
    for (int level = 1; level <= 3; ++level) {
      SCOPED_TRACE(fmt::format("{} at level {}", c.name, level));
      const CellMesh cell = carried(*subdivided(c.mesh, level, 1, c.options, "", whole));
      const auto refiner = refiner_without_border(c.mesh, level, c.options);
      if (opensubdiv_extrapolates(*refiner)) continue;
      const std::vector<Point> points = opensubdiv_points(c.mesh, *refiner);
      int faces = 0;
      const std::set<int> vertices = shown_vertices(refiner->GetLevel(level), faces);
      EXPECT_EQ(cell.owned_faces, std::uint32_t(faces));
      std::set<std::uint32_t> owned;
      for (std::uint32_t f = 0; f < cell.owned_faces; ++f)
        for (std::uint32_t v : cell.mesh.corners(f)) owned.insert(v);
      std::vector<Vec3d> ours, our_limit;
      const LimitSurface limit = limit_surface(cell.mesh, cell.owned_faces, c.options);
      for (std::uint32_t v : owned) {
        ours.push_back(cell.mesh.positions[v]);
        our_limit.push_back(limit.positions[v]);
      }
      expect_same_points(vertices, points, ours);
      std::vector<Point> limits(points.size());
      Far::PrimvarRefinerReal<double>(*refiner).Limit(points, limits);
      expect_same_points(vertices, limits, our_limit);
    }
}

TEST(Subdivide, OfBorderFacesAloneShowsNothing) {
  for (const CellSettings settings : {whole, CellSettings{1, 1}})
    for (const Tessellation& leaf : leaves_of(*subdivided(shapes::bumpy_grid(2), 3, 1, {}, "", settings))) {
      EXPECT_EQ(leaf.face_count, 0u);
      EXPECT_TRUE(leaf.positions.empty());
    }
}

// Two levels by Loop's scheme and then four by Catmull and Clark's, the other way round impossible.
std::shared_ptr<const Model> loop_then_catmull_clark(Mesh base, const std::string& place, CellSettings settings) {
  std::vector<std::unique_ptr<Step>> steps;
  const auto expression = place.empty() ? nullptr : Expression::compile(place, placement_symbols(), ValueType::Vector);
  for (int level = 1; level <= 6; ++level) {
    RefineOptions options;
    if (level <= 2) options.scheme = Scheme::Loop;
    steps.push_back(std::make_unique<SubdivideStep>(
        SubdivideStep::Settings{options, expression, level, refined_step_key(level), Quantum()}));
  }
  return std::make_shared<const Model>("test", std::move(base), std::move(steps), settings);
}

// Corners bit for bit, though triangles are done in one cell while they are made quads in another.
TEST(Subdivide, SchemesMayFollowEachOtherWhereFacesAreDone) {
  const PointFootprint near({1.2, 0.5, 0}, 0.05), fading({1.2, 0.5, 0}, 0.05, true), far({9, 3, 3}, 0.03);
  const ConstantFootprint middling(0.3);
  for (const Mesh& base : {shapes::icosahedron(), triangles_of(shapes::bumpy_grid(5))})
    for (const char* place : {"", "0.3*scale*N*hash(N, P)"})
      for (const Footprint* footprint : std::initializer_list<const Footprint*>{&near, &fading, &far, &middling}) {
        const auto expected = shown_corners(*loop_then_catmull_clark(base, place, whole), footprint);
        EXPECT_GT(expected.size(), 10u);
        for (const CellSettings settings :
             {CellSettings{4, 16}, CellSettings{16, 64}, CellSettings{64, 64}, CellSettings{256, 4}}) {
          const auto cut = shown_corners(*loop_then_catmull_clark(base, place, settings), footprint);
          EXPECT_EQ(cut.size(), expected.size()) << place << ", leaves of " << settings.leaf_faces;
          EXPECT_TRUE(cut == expected) << place << ", leaves of " << settings.leaf_faces;
        }
      }
}

}  // namespace
}  // namespace meristem
