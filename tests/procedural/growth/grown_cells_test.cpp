// Models that grow and are then refined, cut into cells: what the cells are bounded by, and that they fit together.
#include "geometry/cells/expansion.h"
#include "procedural/subdivision/subdivide_step.h"
#include "tests/procedural/growth/derivation.h"
#include "tests/support/point_footprint.h"
#include "tests/support/shown_corners.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>

namespace meristem {
namespace {

using test::Derivation;

// The steps of a derivation, and so many levels of subdivision after them, with placement from the third on.
std::vector<std::unique_ptr<Step>> refined(Derivation& d, int levels,
                                           const decltype(SubdivideStep::Settings::place)& place = nullptr) {
  std::vector<std::unique_ptr<Step>> steps;
  for (auto& step : d.steps) steps.push_back(std::move(step));
  for (int level = 1; level <= levels; ++level) {
    SubdivideStep::Settings s;
    if (level > 2) s.place = place;
    s.level = level;
    s.step_key = hash_keys(3, Key(level));
    steps.push_back(std::make_unique<SubdivideStep>(s));
  }
  return steps;
}

// A shoot of segments that turn anyhow and fork, with spikes on its sides, smoothed and then displaced.
std::shared_ptr<const Model> shrub(const CellSettings& settings, const std::string& thinning = "{}") {
  Derivation d(R"json({"type": "prism", "sides": 6, "radius": 0.1, "height": 0.3, "cap": "shoot(4)"})json",
               {R"json({"grow": 8, "thinning": )json" + thinning + R"json(, "rules": {
                   "shoot(n)": [{"if": "n > 0", "template": "fork", "length": 0.3, "angle": "50 + 30*rand()",
                                 "roll": "360*rand()", "faces": {"left": "stem(n - 1)", "right": "stem(n - 2)"}},
                                {"if": "n <= 0", "template": "spike", "length": 0.2}],
                   "stem(n)": {"template": "segment", "length": 0.3, "taper": 0.9, "bend": "40*rand()",
                               "bend_direction": "360*rand()", "faces": {"cap": "shoot(n)", "side": "thorn"}},
                   "thorn": {"if": "rand() < .3", "template": "spike", "length": "radius"}}})json"});
  EXPECT_TRUE(d.messages().empty());
  const auto place = Expression::compile("0.1*scale*N*snoise(9*P)", placement_symbols(), ValueType::Vector);
  return std::make_shared<const Model>("shrub", d.base, refined(d, 4, place), settings);
}

using Point = std::array<float, 3>;

// All final cells of a model: how they lie in the boxes that were foretold, and whether their triangles, each edge bit
// for bit passed as often in one direction as in the other, close.
struct Cells {
  int leaves = 0, outside = 0;
  double box_area = 0, real_area = 0;
  std::uint64_t made_faces = 0;
  std::map<std::pair<Point, Point>, int> balance;

  Cells(const Model& model, const Footprint* footprint) : model_(model) {
    visit(root_cell(model, footprint), 0, model_bounds(model));
  }
  bool is_closed() const {
    return std::ranges::all_of(balance, [](const auto& edge) { return edge.second == 0; });
  }

 private:
  static double area(const Bounds3f& b) {
    const Vec3f s = b.size();
    return double(s.x * s.y + s.y * s.z + s.z * s.x);
  }

  void visit(CellMesh cell, int level, const Bounds3f& bounds) {
    const Expansion e = expand(model_, std::move(cell), level);
    made_faces += e.faces;
    for (std::size_t i = 0; e.inner && i < e.inner->child_count(); ++i)
      visit(child_cell(model_, *e.inner, i), e.inner->level, e.inner->child_bounds[i]);
    if (!e.leaf) return;
    ++leaves;
    outside += !bounds.contains(e.leaf->bounds());
    box_area += area(bounds);
    real_area += area(e.leaf->bounds());
    for_each_triangle(*e.leaf, [&](const std::array<std::uint32_t, 3>& t, std::uint32_t) {
      for (std::size_t k = 0; k < 3; ++k) pass(e.leaf->positions[t[k]], e.leaf->positions[t[(k + 1) % 3]]);
    });
  }

  void pass(Vec3f a, Vec3f b) {
    const Point p{a.x, a.y, a.z}, q{b.x, b.y, b.z};
    if (p < q) ++balance[{p, q}];
    if (q < p) --balance[{q, p}];
  }

  const Model& model_;
};

constexpr CellSettings small_cells{64, 128}, large_cells{256, 256};
// Of these a mesh on which anything grows may be too large to go on as a whole, and have too little to come for
// children.
constexpr CellSettings tiny_cells{32, 64}, large_leaves{2048, 512};

TEST(GrownCells, LieInTightBoxesAndFitTogether) {
  const PointFootprint near({0.3, 0.5, 0}, 0.005), far({3, 0.5, 0}, 0.003);
  for (const CellSettings& settings : {small_cells, large_cells, tiny_cells, large_leaves}) {
    const auto model = shrub(settings);
    for (const Footprint* footprint : {static_cast<const Footprint*>(nullptr), static_cast<const Footprint*>(&near),
                                       static_cast<const Footprint*>(&far)}) {
      const Cells cells(*model, footprint);
      EXPECT_GT(cells.leaves, settings.leaf_faces > 256 ? 1 : 10);
      EXPECT_EQ(cells.outside, 0);
      EXPECT_TRUE(cells.is_closed());
      EXPECT_LT(cells.box_area, 8 * cells.real_area) << settings.leaf_faces;
    }
  }
}

// Corners bit for bit, with their normals, u and v: of cells of 64 faces as of a whole that is one cell.
TEST(GrownCells, ShowTheSameTrianglesHoweverTheyAreCut) {
  const PointFootprint near({0.3, 0.5, 0}, 0.005), far({3, 0.5, 0}, 0.003), fading({0.3, 0.5, 0}, 0.02, true);
  const ConstantFootprint huge(0.4);
  for (const Footprint* footprint : std::initializer_list<const Footprint*>{nullptr, &near, &far, &fading, &huge}) {
    const auto whole = shown_corners(*shrub({1u << 20, 1u << 20}), footprint);
    EXPECT_GT(whole.size(), 300u);
    for (const CellSettings& settings :
         {small_cells, large_cells, tiny_cells, large_leaves, CellSettings{1024, 4096}}) {
      int leaves = 0;
      const auto cut = shown_corners(*shrub(settings), footprint, &leaves);
      EXPECT_GT(leaves, settings.leaf_faces <= 64 && footprint != &huge ? 10 : 0);
      EXPECT_EQ(cut.size(), whole.size());
      EXPECT_TRUE(cut == whole) << "leaves of " << settings.leaf_faces;
    }
  }
}

// Thorns, and whole shoots, that stand for others and are larger.
TEST(GrownCells, LieInTheirBoxesAndFitTogetherWhereTheyThin) {
  const PointFootprint near({0.3, 0.5, 0}, 0.01), far({3, 0.5, 0}, 0.01), farther({9, 0.5, 0}, 0.01);
  for (const char* thinning : {R"({"thorn": 60})", R"({"shoot": 64, "thorn": 30})"})
    for (const CellSettings& settings : {small_cells, large_cells}) {
      const auto model = shrub(settings, thinning), full = shrub(settings);
      for (const Footprint* footprint : {&near, &far, &farther}) {
        const Cells cells(*model, footprint), without(*full, footprint);
        EXPECT_EQ(cells.outside, 0) << thinning;
        EXPECT_TRUE(cells.is_closed()) << thinning;
        EXPECT_NE(cells.made_faces, without.made_faces) << thinning;
      }
    }
}

std::vector<Point> points_of(const Cells& cells) {
  std::vector<Point> points;
  for (const auto& [edge, balance] : cells.balance) points.insert(points.end(), {edge.first, edge.second});
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

// A level grid, every other face of every other row of which has a bud; each face of the rest touches one.
std::shared_ptr<const Model> lattice_of_buds(const CellSettings& settings) {
  constexpr int side = 24;
  std::string vertices, polygons, names;
  for (int j = 0; j <= side; ++j)
    for (int i = 0; i <= side; ++i) vertices += fmt::format("[{}, 0, {}],", i, -j);
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const int a = j * (side + 1) + i;
      polygons += fmt::format("[{}, {}, {}, {}],", a, a + 1, a + side + 2, a + side + 1);
      names += i % 2 == 0 && j % 2 == 0 ? R"("bud",)" : R"("plain",)";
    }
  Derivation d(fmt::format(R"({{"type": "mesh", "vertices": [{}], "polygons": [{}], "names": [{}],
                               "symbols": {{"bud": "bud"}}}})",
                           vertices, polygons, names),
               {R"({"grow": 1, "rules": {"bud": {"template": "spike", "length": 1}}})"});
  EXPECT_TRUE(d.messages().empty());
  return std::make_shared<const Model>("lattice", d.base, refined(d, 2), settings);
}

// All buds share neighbours with others, and are too many for a cell.
TEST(GrownCells, BudsThatHangTogetherAreCutWhereTheyAreTooMany) {
  const Cells whole(*lattice_of_buds({1u << 20, 1u << 20}), nullptr);
  EXPECT_EQ(whole.leaves, 1);
  for (const CellSettings& settings : {CellSettings{16, 64}, tiny_cells, small_cells, CellSettings{64, 1}}) {
    const Cells cells(*lattice_of_buds(settings), nullptr);
    EXPECT_GT(cells.leaves, 10);
    EXPECT_EQ(cells.outside, 0);
    EXPECT_EQ(points_of(cells), points_of(whole));
  }
}

// A floor of tiles some of which are missing; each that stands is as high as it has others beside it, and so on twice.
std::shared_ptr<const Model> sociable_tiles(const CellSettings& settings, const std::string& thinning = "{}") {
  Derivation d(R"json({"type": "plane", "width": 4, "depth": 4, "columns": 6, "rows": 6, "face": "site"})json",
               {R"json({"grow": 1, "rules": {"site": {"if": "rand() < .6", "template": "extrude", "inset": 0.02,
                    "height": 0.02, "faces": {"cap": "tile(1)", "wall": "tile(2)"}}}})json",
                R"json({"grow": 2, "thinning": )json" + thinning +
                    R"json(, "rules": {"tile(n)": {"if": "rand() < .7", "template": "box",
                    "height": "radius*(.1 + .1*min(neighbors, 4))", "taper": 0.8, "faces": {"top": "tile(neighbors)",
                    "front": "tile(neighbors)", "left": "tile(neighbors)"}}}})json"});
  EXPECT_TRUE(d.messages().empty());
  return std::make_shared<const Model>("tiles", d.base, refined(d, 2), settings);
}

TEST(GrownCells, CountNeighborsAlikeHoweverTheyAreCut) {
  const PointFootprint near({0.3, 0.5, 0}, 0.02), far({3, 1.5, 0}, 0.02);
  for (const Footprint* footprint : {static_cast<const Footprint*>(nullptr), static_cast<const Footprint*>(&near),
                                     static_cast<const Footprint*>(&far)}) {
    for (const char* thinning : {"{}", R"({"tile": 30})"}) {
      const Cells whole(*sociable_tiles({1u << 20, 1u << 20}, thinning), footprint);
      EXPECT_EQ(whole.leaves, 1);
      for (const CellSettings& settings : {CellSettings{16, 64}, small_cells, large_cells}) {
        const Cells cells(*sociable_tiles(settings, thinning), footprint);
        EXPECT_GT(cells.leaves, 10);
        EXPECT_EQ(cells.outside, 0);
        EXPECT_EQ(points_of(cells), points_of(whole));
      }
    }
  }
}

// Thorns far smaller than a pixel are done long before the stem they stand on.
TEST(GrownCells, NoLevelIsSpentOnFacesThatAreDone) {
  const PointFootprint near({0.3, 0.5, 0}, 0.05);
  const auto model = shrub({1u << 20, 1u << 20});
  const Cells cells(*model, &near), all(*model, nullptr);
  EXPECT_TRUE(cells.is_closed());
  EXPECT_LT(cells.made_faces, all.made_faces / 3);
}

}  // namespace
}  // namespace meristem
