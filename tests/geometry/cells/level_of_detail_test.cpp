#include "geometry/cells/level_of_detail.h"

#include "geometry/cells/expansion.h"
#include "tests/support/point_footprint.h"
#include "tests/support/test_model.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <map>
#include <set>

namespace meristem {
namespace {

using Point = std::array<float, 3>;

// Calls visit(a, b, c) for the corners of every triangle that a model comes to, seen through a footprint.
void for_each_triangle(const Model& model, CellMesh cell, int level,
                       const std::function<void(Vec3f, Vec3f, Vec3f)>& visit) {
  const Expansion e = expand(model, std::move(cell), level);
  for (std::size_t i = 0; e.inner && i < e.inner->child_count(); ++i)
    for_each_triangle(model, child_cell(model, *e.inner, i), e.inner->level, visit);
  if (!e.leaf) return;
  const Tessellation& t = *e.leaf;
  for (const auto& g : t.grids)
    for (std::uint32_t j = 0; j + 1 < g.height; ++j)
      for (std::uint32_t i = 0; i + 1 < g.width; ++i) {
        const std::uint32_t a = g.first_vertex + j * g.width + i, b = a + 1, c = a + g.width, d = c + 1;
        visit(t.positions[a], t.positions[b], t.positions[c]);
        visit(t.positions[d], t.positions[c], t.positions[b]);
      }
  for (const auto& k : t.triangles) visit(t.positions[k[0]], t.positions[k[1]], t.positions[k[2]]);
}

// Every edge, from vertex to vertex bit for bit, is passed as often in one direction as in the other.
struct Surface {
  std::map<std::pair<Point, Point>, int> balance;
  std::set<Point> vertices;
  std::size_t triangles = 0;
  double smallest = INFINITY, largest = 0;

  explicit Surface(const Model& model, const Footprint* footprint) {
    for_each_triangle(model, root_cell(model, footprint), 0, [this](Vec3f a, Vec3f b, Vec3f c) {
      pass(a, b);
      pass(b, c);
      pass(c, a);
      const double area = double(length(cross(b - a, c - a)));
      if (area == 0) return;
      ++triangles;
      for (Vec3f p : {a, b, c}) vertices.insert({p.x, p.y, p.z});
      smallest = std::min(smallest, area);
      largest = std::max(largest, area);
    });
  }
  bool is_closed() const {
    for (const auto& [edge, count] : balance)
      if (count != 0) return false;
    return true;
  }

 private:
  void pass(Vec3f a, Vec3f b) {
    const Point p{a.x, a.y, a.z}, q{b.x, b.y, b.z};
    if (p < q) ++balance[{p, q}];
    if (q < p) --balance[{q, p}];
  }
};

const CellSettings small_cells{64, 64};

TEST(LevelOfDetail, SurfaceStaysClosedWhereLevelsMeet) {
  for (double pixel : {0.2, 0.05, 0.02}) {
    const auto model = bumpy_model(shapes::prism(7), 7, 0.2, small_cells);
    const PointFootprint near({1.2, 0.5, 0}, pixel);
    const Surface surface(*model, &near);
    EXPECT_TRUE(surface.is_closed()) << pixel;
    EXPECT_GT(surface.largest / surface.smallest, 64) << "one level would not show";
  }
}

TEST(LevelOfDetail, CutIntoCellsOrNotGivesTheSameVertices) {
  const PointFootprint near({1.2, 0.5, 0}, 0.05);
  const Surface small(*bumpy_model(shapes::prism(7), 6, 0.2, small_cells), &near),
      whole(*bumpy_model(shapes::prism(7), 6, 0.2, {1u << 20, 1u << 20}), &near);
  EXPECT_TRUE(whole.is_closed());
  EXPECT_EQ(small.vertices, whole.vertices);
  EXPECT_EQ(small.smallest, whole.smallest);
  EXPECT_EQ(small.largest, whole.largest);
}

TEST(LevelOfDetail, FacesAreAsLargeAsWanted) {
  for (double wanted : {0.1, 0.05, 0.02}) {
    const ConstantFootprint footprint(wanted);
    const Surface surface(*bumpy_model(shapes::cube(), 9, 0, small_cells), &footprint);
    // Twice the area of half a square; a level halves the size, and faces of one level differ.
    EXPECT_LT(surface.largest, wanted * wanted * 1.6) << wanted;
    EXPECT_GT(surface.largest, wanted * wanted / 4.5) << wanted;
  }
}

TEST(LevelOfDetail, EverythingInFullWhereTheFootprintIsTiny) {
  const ConstantFootprint tiny(1e-12);
  const Surface all(*bumpy_model(shapes::cube(), 4, 0.2, small_cells), nullptr),
      fine(*bumpy_model(shapes::cube(), 4, 0.2, small_cells), &tiny);
  EXPECT_EQ(all.balance, fine.balance);
}

TEST(LevelOfDetail, AnObjectSmallerThanAPixelIsItsBaseMesh) {
  const ConstantFootprint huge(1e3);
  const Surface surface(*bumpy_model(shapes::cube(), 6, 0.1, small_cells), &huge);
  EXPECT_EQ(surface.triangles, 12u);
}

// The limit surface does not depend on the level at which a vertex froze, be it the cage with faces of any size.
TEST(LevelOfDetail, FrozenVerticesOfASmoothModelLieOnItsLimitSurface) {
  const PointFootprint near({2, 0, 0}, 0.05);
  const ConstantFootprint huge(1e3);
  for (const Mesh& cage : {shapes::cube(), shapes::prism(7)}) {
    const auto model = bumpy_model(cage, 7, 0, small_cells);
    std::map<Point, int> full;
    for_each_triangle(*model, root_cell(*model), 0, [&](Vec3f a, Vec3f, Vec3f) { ++full[{a.x, a.y, a.z}]; });
    const auto is_near_limit = [&](Vec3f p) {
      for (auto it = full.lower_bound({p.x - 2e-6f, -10, -10}); it != full.end() && it->first[0] < p.x + 2e-6f; ++it)
        if (std::abs(it->first[1] - p.y) < 2e-6f && std::abs(it->first[2] - p.z) < 2e-6f) return true;
      return false;
    };
    for (const Footprint* footprint : {static_cast<const Footprint*>(&near), static_cast<const Footprint*>(&huge)}) {
      std::size_t seen = 0, wrong = 0;
      for_each_triangle(*model, root_cell(*model, footprint), 0, [&](Vec3f a, Vec3f, Vec3f) {
        ++seen;
        wrong += !is_near_limit(a);
      });
      EXPECT_GT(seen, 0u);
      EXPECT_EQ(wrong, 0u);
    }
  }
}

}  // namespace
}  // namespace meristem
