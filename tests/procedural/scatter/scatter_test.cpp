#include "procedural/scatter/scatter.h"

#include "geometry/cells/expansion.h"
#include "geometry/cells/placed_footprint.h"
#include "procedural/subdivision/subdivide_step.h"
#include "tests/procedural/growth/derivation.h"
#include "tests/support/test_model.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

namespace meristem {
namespace {

// A horizontal square of side 100 as 10 x 10 quads, facing up.
CellMesh meadow() {
  Mesh mesh;
  for (int j = 0; j <= 10; ++j)
    for (int i = 0; i <= 10; ++i) mesh.add_vertex({10.0 * i, 0, 10.0 * j}, hash_keys(Key(i), Key(j)));
  mesh.origins.emplace_back();
  for (std::uint32_t j = 0; j < 10; ++j)
    for (std::uint32_t i = 0; i < 10; ++i) {
      const std::uint32_t a = j * 11 + i;
      mesh.add_face(std::array{a, a + 11, a + 12, a + 1}, hash_keys(7, Key(a)), 0);
    }
  CellMesh cell;
  cell.owned_faces = mesh.face_count();
  cell.rings.assign(mesh.face_count(), 0);
  cell.mesh = std::move(mesh);
  return cell;
}

std::shared_ptr<const Part> cube() {
  return std::make_shared<const Part>(
      std::make_shared<const Model>("cube", shapes::cube(), std::vector<std::unique_ptr<Step>>{}));
}

ScatterSettings settings(const char* density, const char* scale) {
  ScatterSettings s;
  s.density = Expression::compile(density, ground_symbols(), ValueType::Scalar);
  s.scale = Expression::compile(scale, ground_symbols(), ValueType::Scalar);
  return s;
}

std::vector<Placement> placed(const Scatter& scatter, const CellMesh& ground) {
  std::vector<Placement> list;
  const auto furnishing = scatter.furnish(ground, 0);
  furnishing->place(0, furnishing->face_count(), list);
  return list;
}

TEST(Scatter, DensityIsTheNumberForEachSquareMetre) {
  double total = 0;
  for (Key seed = 0; seed < 20; ++seed)
    total += double(placed(Scatter(settings("0.05", "1"), {{cube(), 1}}, seed), meadow()).size());
  // 20 x 10^4 m^2 x 0.05; only the fraction of each face is left to chance
  EXPECT_NEAR(total, 10000, 4 * std::sqrt(2000 * 0.25));
}

TEST(Scatter, DensityMayVaryOverTheGround) {
  const auto list = placed(Scatter(settings("P[0] < 50 ? 0.2 : 0", "1"), {{cube(), 1}}, 1), meadow());
  EXPECT_GT(list.size(), 900u);
  for (const Placement& p : list) EXPECT_LT(p.to_parent.origin.x, 50);
}

TEST(Scatter, PlacesSpreadEvenlyOverAFace) {
  int quadrant[4] = {};
  for (Key seed = 0; seed < 10; ++seed)
    for (const Placement& p : placed(Scatter(settings("0.1", "1"), {{cube(), 1}}, seed), meadow())) {
      const double x = std::fmod(p.to_parent.origin.x, 10), z = std::fmod(p.to_parent.origin.z, 10);
      ++quadrant[(x > 5) + 2 * (z > 5)];
    }
  for (int count : quadrant) EXPECT_NEAR(count, 2500, 4 * std::sqrt(2500.0));
}

TEST(Scatter, AFaceIsFurnishedAlikeInEveryCell) {
  const CellMesh all = meadow();
  CellMesh part = all;
  part.owned_faces = 30;
  const Scatter scatter(settings("0.03", "0.5 + rand()"), {{cube(), 1}}, 5);
  const auto whole = placed(scatter, all), some = placed(scatter, part);
  ASSERT_LT(some.size(), whole.size());
  for (std::size_t i = 0; i < some.size(); ++i) {
    EXPECT_EQ(some[i].to_parent, whole[i].to_parent);
    EXPECT_EQ(some[i].individual, whole[i].individual);
  }
}

TEST(Scatter, NoTwoAreAlikeUnlessVariantsAreAskedFor) {
  std::set<Key> distinct, variants;
  ScatterSettings s = settings("0.05", "1");
  for (const Placement& p : placed(Scatter(s, {{cube(), 1}}, 1), meadow())) {
    distinct.insert(p.individual);
    EXPECT_FALSE(p.is_shared);
  }
  EXPECT_GT(distinct.size(), 450u);
  s.variants = 6;
  for (const Placement& p : placed(Scatter(s, {{cube(), 1}}, 1), meadow())) variants.insert(p.individual);
  EXPECT_EQ(variants.size(), 6u);
}

// Calls visit(bounds) for every final cell below one.
void visit_leaves(const Model& model, CellMesh cell, int level, const std::function<void(const Bounds3f&)>& visit) {
  const Expansion e = expand(model, std::move(cell), level);
  if (e.leaf) return visit(e.leaf->bounds());
  for (std::size_t i = 0; i < e.inner->child_count(); ++i)
    visit_leaves(model, child_cell(model, *e.inner, i), e.inner->level, visit);
}

// The corners of a cage stand out from the ball that it is smoothed to; seen small, the cage is what is shown.
TEST(Scatter, BoundsOfAVariantHoldOnEveryLevelOfDetail) {
  const auto model = bumpy_model(shapes::tetrahedron(), 7, 0);
  ScatterSettings s = settings("0.05", "1");
  s.variants = 3;
  const Scatter scatter(s, {{std::make_shared<const Part>(model), 1}}, 1);
  for (const Placement& p : placed(scatter, meadow())) {
    ASSERT_FALSE(p.known_bounds.empty());
    for (const double pixel : {10.0, 1.0, 0.3, 0.1}) {
      const ConstantFootprint footprint(pixel);
      visit_leaves(*model, root_cell(*model, &footprint, p.individual), 0,
                   [&](const Bounds3f& real) { EXPECT_TRUE(p.known_bounds.contains(real)) << pixel; });
    }
  }
}

// A ball of leaves that thin where they are seen small, the largest of them on its outside; `place`, if not null,
// displaces them.
std::shared_ptr<const Model> leafy_ball(int divisions, const char* place = nullptr) {
  test::Derivation d(fmt::format(R"({{"type": "sphere", "radius": 0.5, "divisions": {}, "face": "leaf"}})", divisions),
                     {R"json({"grow": 1, "thinning": {"leaf": 32}, "rules": {"leaf": {"template": "leaf", "length": 0.1,
                              "width": 0.05, "bend": "80*rand()", "bend_direction": "360*rand()"}}})json"});
  EXPECT_TRUE(d.messages().empty());
  std::vector<std::unique_ptr<Step>> steps;
  for (auto& step : d.steps) steps.push_back(std::move(step));
  for (int level = 1; level <= 2; ++level) {
    SubdivideStep::Settings s;
    if (place) s.place = Expression::compile(place, placement_symbols(), ValueType::Vector);
    s.level = level;
    s.step_key = hash_keys(3, Key(level));
    steps.push_back(std::make_unique<SubdivideStep>(s));
  }
  return std::make_shared<const Model>("ball", d.base, std::move(steps));
}

double side(const Bounds3f& b) { return double(max_component(b.size())); }

// What is enlarged reaches as far as its footprint makes it: not to where it could at the worst, and not only as far as
// in full. In models of some hundred faces and of many.
TEST(Scatter, BoundsHoldWhatIsEnlargedAndLittleMore) {
  for (const int divisions : {2, 6})
    for (const char* place : {static_cast<const char*>(nullptr), "0.2*scale*N*snoise(9*P)"}) {
      const auto model = leafy_ball(divisions, place);
      const auto part = std::make_shared<const Part>(model);
      ScatterSettings s = settings("0.05", "1");
      s.variants = 3;
      const Scatter scatter(s, {{part, 1}}, 1);
      const CellMesh ground = meadow();
      const auto furnishing = scatter.furnish(ground, 0);
      int beyond_full = 0;
      for (const double pixel : {0.01, 0.03, 0.1}) {
        const ConstantFootprint footprint(pixel);
        const auto reach = scatter.reach_on(furnishing->ground_bounds(), &footprint, 0);
        std::set<Key> seen;
        for (const Placement& p : placed(scatter, ground)) {
          if (!seen.insert(p.individual).second) continue;
          const Bounds3f bounds = bounds_of_individual(*part, &footprint, p.individual, placed_bounds(p));
          EXPECT_LT(side(bounds), side(placed_bounds(p)) + (place ? 300 : 130) * pixel) << divisions << ' ' << pixel;
          EXPECT_TRUE(bounds_with_reach(furnishing->ground_bounds(), reach->all).contains(bounds_in_parent(p, bounds)));
          visit_leaves(*model, root_cell(*model, &footprint, p.individual), 0, [&](const Bounds3f& real) {
            EXPECT_TRUE(bounds.contains(real)) << divisions << ' ' << pixel;
            beyond_full += !placed_bounds(p).contains(real);
          });
        }
        EXPECT_LE(side(reach->all), (pixel < 0.02 ? 0.5 : 1) * side(scatter.reach()));
      }
      EXPECT_TRUE(beyond_full > 0 || divisions == 2);
      EXPECT_LT(side(part->typical), 0.5 * side(part->bounds));
    }
}

// Placed in an individual of its own, a variant is another than the one that was measured.
TEST(Scatter, NothingIsKnownOfVariantsOfOtherIndividuals) {
  ScatterSettings s = settings("0.05", "1");
  s.variants = 3;
  const Scatter scatter(s, {{std::make_shared<const Part>(leafy_ball(6)), 1}}, 1);
  const CellMesh ground = meadow();
  std::vector<Placement> list;
  const auto furnishing = scatter.furnish(ground, 7);
  furnishing->place(0, furnishing->face_count(), list);
  ASSERT_FALSE(list.empty());
  for (const Placement& p : list) EXPECT_TRUE(p.known_bounds.empty());
  EXPECT_TRUE(scatter.reach_on(furnishing->ground_bounds(), nullptr, 7)->kinds.empty());
  EXPECT_FALSE(scatter.reach_on(furnishing->ground_bounds(), nullptr, 0)->kinds.empty());
}

TEST(Scatter, WeightsChooseAmongKinds) {
  const auto a = cube(), b = cube();
  int count_a = 0;
  const auto list = placed(Scatter(settings("0.5", "1"), {{a, 3}, {b, 1}}, 2), meadow());
  for (const Placement& p : list) count_a += p.part == a;
  EXPECT_NEAR(count_a, 0.75 * double(list.size()), 4 * std::sqrt(double(list.size()) * 0.19));
}

TEST(Scatter, NothingReachesBeyondItsReach) {
  ScatterSettings s = settings("0.1", "1 + 2*rand()");
  s.align = 1;
  s.sink = 0.5;
  const Scatter scatter(s, {{cube(), 1}}, 3);
  for (const Placement& p : placed(scatter, meadow())) {
    const Bounds3f& b = p.part->bounds;
    const Bounds3d there = p.to_parent.bounds(Bounds3d{Vec3d(b.lower), Vec3d(b.upper)});
    EXPECT_LT(scatter.reach().lower.y, there.lower.y);
    EXPECT_GT(scatter.reach().upper.y, there.upper.y);
  }
}

TEST(Scatter, BareGroundIsKnownByItsBox) {
  const Scatter scatter(settings("P[0] < 50 ? 0.2 : 0", "1"), {{cube(), 1}}, 1);
  EXPECT_TRUE(scatter.leaves_bare({{60, -5, 0}, {90, 5, 100}}));
  EXPECT_FALSE(scatter.leaves_bare({{40, -5, 0}, {90, 5, 100}}));
}

TEST(Scatter, FacesMayBeFurnishedOneByOne) {
  const Scatter scatter(settings("0.05", "1 + rand()"), {{cube(), 1}}, 1);
  const auto furnishing = scatter.furnish(meadow(), 0);
  std::vector<Placement> one_by_one;
  for (std::uint32_t f = 0; f < furnishing->face_count(); ++f) {
    const std::size_t before = one_by_one.size();
    furnishing->place(f, f + 1, one_by_one);
    EXPECT_EQ(one_by_one.size() - before, furnishing->most_on(f));
  }
  const auto all = placed(scatter, meadow());
  ASSERT_EQ(all.size(), one_by_one.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].to_parent, one_by_one[i].to_parent);
    EXPECT_EQ(all[i].individual, one_by_one[i].individual);
  }
}

bool holds(const Bounds3f& bounds, const Placement& p) { return bounds.contains(bounds_in_parent(p, p.part->bounds)); }

// Where a cube is seen smaller than `distinct` pixels its variant stands.
TEST(Scatter, ReachIsKnownByKindWhereVariantsStand) {
  ScatterSettings s = settings("0.05", "1 + rand()");
  s.variants = 3;
  s.distinct = 10;
  s.sink = 0.25;
  const auto small = cube();
  const auto large = std::make_shared<const Part>(
      std::make_shared<const Model>("large", shapes::cube(4), std::vector<std::unique_ptr<Step>>{}));
  const Scatter scatter(s, {{small, 1}, {large, 1}}, 3);
  const auto furnishing = scatter.furnish(meadow(), 0);
  const Bounds3f ground = furnishing->ground_bounds();
  const ConstantFootprint near(0.1), far(3);
  EXPECT_TRUE(scatter.reach_on(ground, nullptr, 0)->kinds.empty());
  EXPECT_TRUE(scatter.reach_on(ground, &near, 0)->kinds.empty());
  const auto reach = scatter.reach_on(ground, &far, 0);
  EXPECT_EQ(reach->kinds.size(), 6u);
  const Bounds3f everywhere = bounds_with_reach(ground, reach->all);
  double volumes = 0, general_volumes = 0;
  for (std::uint32_t f = 0; f < furnishing->face_count(); ++f) {
    const Bounds3f bounds = furnishing->bounds(f, f + 1, *reach), loose = furnishing->bounds(f, f + 1, {reach->all});
    std::vector<Placement> placements;
    furnishing->place(f, f + 1, placements);
    EXPECT_EQ(bounds.empty(), placements.empty());
    for (const Placement& p : placements) {
      EXPECT_TRUE(holds(bounds, p));
      EXPECT_TRUE(holds(loose, p));
      EXPECT_TRUE(holds(everywhere, p));
    }
    if (placements.empty()) continue;
    volumes += double(bounds.surface_area());
    general_volumes += double(loose.surface_area());
  }
  EXPECT_LT(volumes, 0.8 * general_volumes);
}

TEST(Scatter, ScaleNeedsABound) { EXPECT_THROW(Scatter(settings("1", "P[0]"), {{cube(), 1}}, 0), std::runtime_error); }

}  // namespace
}  // namespace meristem
