#include "geometry/cells/level_of_detail.h"

#include "geometry/cells/expansion.h"
#include "geometry/cells/position_lattice.h"
#include "tests/support/point_footprint.h"
#include "tests/support/shown_corners.h"
#include "tests/support/shown_triangles.h"
#include "tests/support/test_model.h"

#include <gtest/gtest.h>

#include <array>
#include <map>

namespace meristem {
namespace {

const CellSettings small_cells{64, 64};

TEST(LevelOfDetail, SurfaceStaysClosedWhereLevelsMeet) {
  for (double pixel : {0.2, 0.05, 0.02}) {
    const auto model = bumpy_model(shapes::prism(7), 7, 0.2, small_cells);
    const PointFootprint near({1.2, 0.5, 0}, pixel);
    const ShownTriangles surface(*model, &near);
    EXPECT_TRUE(surface.is_closed()) << pixel;
    EXPECT_GT(surface.largest / surface.smallest, 64) << "one level would not show";
  }
}

TEST(LevelOfDetail, CutIntoCellsOrNotGivesTheSameVertices) {
  const PointFootprint near({1.2, 0.5, 0}, 0.05);
  const ShownTriangles small(*bumpy_model(shapes::prism(7), 6, 0.2, small_cells), &near),
      whole(*bumpy_model(shapes::prism(7), 6, 0.2, {1u << 20, 1u << 20}), &near);
  EXPECT_TRUE(whole.is_closed());
  EXPECT_TRUE(are_alike(small, whole));
}

// A mesh of u and v by corner, one edge of whose faces is a seam.
Mesh with_uv(Mesh mesh) {
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    for (std::uint32_t k = 0; k < mesh.corner_count(f); ++k)
      mesh.corner_uv.push_back({0.13 * double(f) + (k == 1 || k == 2 ? 0.13 : 0), k < 2 ? 0.03 : 41.7});
  return mesh;
}

// The same, where all of a face's edges are seams that stay.
Mesh with_seams(Mesh mesh) {
  mesh = with_uv(std::move(mesh));
  keep_seams(mesh);
  EXPECT_TRUE(has_seams(mesh));
  return mesh;
}

// Bit for bit, with all that is known at their corners. Faces that are done are shown refined in one cell, and by
// themselves in another; some have no four corners.
TEST(LevelOfDetail, CutIntoCellsOrNotShowsTheSameTriangles) {
  const PointFootprint near({1.2, 0.5, 0}, 0.05), fading({1.2, 0.5, 0}, 0.05, true), far({40, 9, 3}, 0.02);
  for (const Mesh& base : {with_uv(shapes::prism(7)), with_uv(shapes::tetrahedron()), shapes::prism(3),
                           with_seams(shapes::prism(7)), with_seams(shapes::tetrahedron())})
    for (const Footprint* footprint : std::initializer_list<const Footprint*>{&near, &fading, &far, nullptr}) {
      const int levels = footprint ? 7 : 4;
      const auto whole = shown_corners(*bumpy_model(base, levels, 0.2, {1u << 20, 1u << 20}), footprint);
      EXPECT_GT(whole.size(), 10u);
      for (const CellSettings settings : {CellSettings{4, 16}, small_cells, CellSettings{256, 128}}) {
        const auto cut = shown_corners(*bumpy_model(base, levels, 0.2, settings), footprint);
        EXPECT_EQ(cut.size(), whole.size());
        EXPECT_TRUE(cut == whole) << "leaves of " << settings.leaf_faces;
      }
    }
}

// Every face of the base keeps to its own strip of the texture, on however many levels its parts are shown.
TEST(LevelOfDetail, SeamsOfTexturesStay) {
  const PointFootprint near({1.2, 0.5, 0}, 0.05), fading({1.2, 0.5, 0}, 0.05, true);
  Mesh base = shapes::prism(7);
  for (std::uint32_t f = 0; f < base.face_count(); ++f)
    for (std::uint32_t k = 0; k < base.corner_count(f); ++k) base.corner_uv.push_back({f + 0.25 + 0.5 * (k & 1), 0.5});
  keep_seams(base);
  for (const Footprint* footprint : std::initializer_list<const Footprint*>{&near, &fading, nullptr}) {
    const auto model = bumpy_model(base, footprint ? 7 : 4, 0.2, small_cells);
    EXPECT_TRUE(ShownTriangles(*model, footprint).is_closed());
    std::array<int, 9> seen{};
    for (const auto& corners : shown_corners(*model, footprint)) {
      const float strip = std::floor(corners[0][6]);
      for (const auto& corner : corners) {
        ASSERT_GE(corner[6], strip + 0.25f);
        ASSERT_LE(corner[6], strip + 0.75f);
      }
      ++seen.at(std::size_t(strip));
    }
    for (const int triangles : seen) EXPECT_GT(triangles, 1);
  }
}

TEST(LevelOfDetail, FacesAreAsLargeAsWanted) {
  for (double wanted : {0.1, 0.05, 0.02}) {
    const ConstantFootprint footprint(wanted);
    const ShownTriangles surface(*bumpy_model(shapes::cube(), 9, 0, small_cells), &footprint);
    // Twice the area of half a square; a level halves the size, and faces of one level differ.
    EXPECT_LT(surface.largest, wanted * wanted * 1.6) << wanted;
    EXPECT_GT(surface.largest, wanted * wanted / 4.5) << wanted;
  }
}

TEST(LevelOfDetail, EverythingInFullWhereTheFootprintIsTiny) {
  const ConstantFootprint tiny(1e-12);
  const auto model = bumpy_model(shapes::cube(), 4, 0.2, small_cells);
  const ShownTriangles all(*model, nullptr), fine(*model, &tiny);
  EXPECT_TRUE(fine.is_near(all, float(PositionLattice::margin(*model))));
}

TEST(LevelOfDetail, AnObjectSmallerThanAPixelIsItsBaseMesh) {
  const ConstantFootprint huge(1e3);
  const ShownTriangles surface(*bumpy_model(shapes::cube(), 6, 0.1, small_cells), &huge);
  EXPECT_EQ(surface.triangles, 12u);
}

// The limit surface does not depend on the level at which a vertex froze, be it the cage with faces of any size.
TEST(LevelOfDetail, FrozenVerticesOfASmoothModelLieOnItsLimitSurface) {
  const PointFootprint near({2, 0, 0}, 0.05);
  const ConstantFootprint huge(1e3);
  for (const Mesh& cage : {shapes::cube(), shapes::prism(7)}) {
    const auto model = bumpy_model(cage, 7, 0, small_cells);
    std::map<std::array<float, 3>, int> full;
    for_each_shown_triangle(*model, root_cell(*model), 0, [&](Vec3f a, Vec3f, Vec3f) { ++full[{a.x, a.y, a.z}]; });
    const float most = 2e-6f + float(PositionLattice::margin(*model));
    const auto is_near_limit = [&](Vec3f p) {
      for (auto it = full.lower_bound({p.x - most, -10, -10}); it != full.end() && it->first[0] < p.x + most; ++it)
        if (std::abs(it->first[1] - p.y) < most && std::abs(it->first[2] - p.z) < most) return true;
      return false;
    };
    for (const Footprint* footprint : {static_cast<const Footprint*>(&near), static_cast<const Footprint*>(&huge)}) {
      std::size_t seen = 0, wrong = 0;
      for_each_shown_triangle(*model, root_cell(*model, footprint), 0, [&](Vec3f a, Vec3f, Vec3f) {
        ++seen;
        wrong += !is_near_limit(a);
      });
      EXPECT_GT(seen, 0u);
      EXPECT_EQ(wrong, 0u);
    }
  }
}

TEST(LevelOfDetail, BoxesHoldWhereFrozenVerticesAreShown) {
  const PointFootprint near({2, 0, 0}, 0.3);
  for (const Mesh& cage : {shapes::cube(), shapes::prism(7)}) {
    const auto model = bumpy_model(cage, 7, 0, small_cells);
    CellMesh cell = root_cell(*model, &near);
    std::map<std::uint32_t, Bounds3d> boxes;
    for (int level = 0; boxes.empty() && level < 4; ++level) {
      CellMesh in_boxes = cell;
      freeze_in_boxes(*model, in_boxes, level, nullptr,
                      [&](std::uint32_t v, const Bounds3d& box) { boxes[v] = box.inflated(Vec3d(1e-6)); });
      freeze_vertices(*model, cell, level);
      for (std::uint32_t v = 0; v < cell.mesh.frozen.size(); ++v) {
        ASSERT_EQ(cell.mesh.frozen[v].is_frozen, boxes.count(v) > 0);
        EXPECT_TRUE(!boxes.count(v) || boxes[v].contains(Vec3d(cell.mesh.frozen[v].position)));
      }
      CellMesh next;
      model->step(level).apply(cell, model->halo_rings(level + 1), next);
      next.footprint = &near;
      cell = std::move(next);
    }
    EXPECT_FALSE(boxes.empty());
  }
}

}  // namespace
}  // namespace meristem
