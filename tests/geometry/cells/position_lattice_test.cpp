#include "geometry/cells/position_lattice.h"

#include "geometry/cells/expansion.h"
#include "geometry/cells/level_of_detail.h"
#include "geometry/cells/surface_vertices.h"
#include "tests/support/point_footprint.h"
#include "tests/support/test_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace meristem {
namespace {

bool is_multiple(double x, double step) { return std::remainder(x, step) == 0; }

// Calls visit(surface) for every leaf.
void visit_leaves(const Model& model, CellMesh cell, int level, const std::function<void(const Tessellation&)>& visit) {
  const Expansion e = expand(model, std::move(cell), level);
  for (std::size_t i = 0; e.inner && i < e.inner->child_count(); ++i)
    visit_leaves(model, child_cell(model, *e.inner, i), e.inner->level, visit);
  if (e.leaf) visit(*e.leaf);
}

// A cell of two refinements, with its scales.
CellMesh refined(const Model& model, const Footprint& footprint) {
  CellMesh cell = root_cell(model, &footprint);
  for (int level = 0; level < 2; ++level) {
    measure_nominal_scale(model, cell, level);
    CellMesh out;
    model.step(level).apply(cell, model.halo_rings(level + 1), out);
    out.footprint = &footprint;
    cell = std::move(out);
  }
  measure_nominal_scale(model, cell, 2);
  return cell;
}

TEST(PositionLattice, StepsAreASmallShareOfTheFaces) {
  const auto model = bumpy_model(shapes::cube(), 6, 0.2);
  const ConstantFootprint footprint(1e-3);
  const CellMesh cell = refined(*model, footprint);
  const PositionLattice lattice(*model, cell);
  const Vec3f p{0.123456f, -0.654321f, 0.3333333f};
  int moved = 0;
  for (std::uint32_t v = 0; v < cell.mesh.vertex_count(); ++v) {
    const Vec3f rounded = lattice.round(v, p);
    const double scale = cell.mesh.nominal_scale[v], most = 2 * PositionLattice::margin(*model);
    const double step = std::min(std::exp2(std::floor(std::log2(scale))) / 256, most);
    for (const float x : {rounded.x, rounded.y, rounded.z}) EXPECT_TRUE(is_multiple(double(x), step));
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_LE(std::abs(double(rounded[axis]) - double(p[axis])), PositionLattice::margin(*model));
    moved += rounded != p;
  }
  EXPECT_GT(moved, 0);
}

TEST(PositionLattice, LeavesAloneWhatHasNoFootprintOrIsShownAsGiven) {
  const auto model = bumpy_model(shapes::cube(), 6, 0.2), given = bumpy_model(shapes::cube(), 0, 0);
  const ConstantFootprint footprint(1e-3);
  CellMesh cell = refined(*model, footprint);
  const Vec3f p{0.123456f, -0.654321f, 0.3333333f};
  EXPECT_NE(PositionLattice(*model, cell).round(0, p), p);
  EXPECT_EQ(PositionLattice(*given, cell).round(0, p), p);
  cell.footprint = nullptr;
  EXPECT_EQ(PositionLattice(*model, cell).round(0, p), p);
}

TEST(PositionLattice, IsTheCoarsestForVerticesWithoutAScale) {
  const auto model = bumpy_model(shapes::cube(), 6, 0.2);
  const ConstantFootprint footprint(1e-3);
  CellMesh cell = refined(*model, footprint);
  cell.mesh.nominal_scale[0] = 0;
  const Vec3f p = PositionLattice(*model, cell).round(0, {0.123456f, -0.654321f, 0.3333333f});
  for (const float x : {p.x, p.y, p.z}) EXPECT_TRUE(is_multiple(double(x), model->coarsest_lattice()));
}

TEST(PositionLattice, NoZeroIsNegative) {
  const auto model = bumpy_model(shapes::cube(), 6, 0.2);
  const ConstantFootprint footprint(1e-3);
  CellMesh cell = refined(*model, footprint);
  const Vec3f rounded = PositionLattice(*model, cell).round(0, {-0.f, -1e-12f, 1});
  EXPECT_FALSE(std::signbit(rounded.x) || std::signbit(rounded.y));
  cell.footprint = nullptr;
  EXPECT_FALSE(std::signbit(PositionLattice(*model, cell).round(0, {-0.f, 1, 1}).x));
}

// What all this is for. Small leaves of rough faces, of one level and of several.
TEST(PositionLattice, SurfacesOfFacesAsSmallAsWantedCanBePacked) {
  const auto model = bumpy_model(shapes::prism(7), 8, 0.2);
  const PointFootprint near({1.2, 0.5, 0}, 0.01), far({9, 3, 0}, 0.002);
  for (const Footprint* footprint : {&near, &far}) {
    std::size_t packed = 0, all = 0;
    visit_leaves(*model, root_cell(*model, footprint), 0, [&](const Tessellation& t) {
      const SurfaceVertices vertices(t.positions, t.attributes, t.has_uv);
      all += vertices.size();
      packed += vertices.positions().is_packed() ? vertices.size() : 0;
    });
    EXPECT_GT(all, 5000u);
    EXPECT_GT(double(packed), 0.95 * double(all));
  }
}

TEST(UvReaders, LeaveOutUvWhereNoMaterialOfTheFacesReadsThem) {
  const auto model = bumpy_model(shapes::cube(), 3, 0.2);
  const auto surface_for = [&](const UvReaders& readers) {
    CellMesh cell = root_cell(*model);
    for (FaceOrigin& origin : cell.mesh.origins) origin.material = 1;
    return std::move(*expand(*model, std::move(cell), 0, readers).leaf);
  };
  EXPECT_TRUE(surface_for({}).has_uv);
  EXPECT_TRUE(surface_for(UvReaders({false, true, false})).has_uv);
  EXPECT_TRUE(surface_for(UvReaders({false})).has_uv) << "a material that is not known";
  const Tessellation without = surface_for(UvReaders({true, false, true})), with = surface_for({});
  EXPECT_FALSE(without.has_uv);
  EXPECT_EQ(without.positions, with.positions);
}

}  // namespace
}  // namespace meristem
