// Detail by range against the paper's table, in fractions: an aspen in summer with quality 1.
#include "tests/procedural/plants/plant_support.h"

#include "procedural/plants/leaf_shape.h"

#include <gtest/gtest.h>

namespace meristem::test {
namespace {

constexpr double ranges[] = {5, 30, 60, 120, 240, 600, 1200};

template <class Fraction>
void expect_fractions(const std::vector<double>& drawn, const Fraction& fraction) {
  for (std::size_t i = 0; i < drawn.size(); ++i)
    EXPECT_NEAR(fraction(ranges[i]), drawn[i] / drawn[0], 0.03) << "range " << ranges[i];
}

TEST(PlantDetail, FractionsByRangeAreThoseOfTheTable) {
  const double s = 0.5, d = 200;
  using namespace degradation;
  expect_fractions({960, 960, 960, 0, 0, 0, 0}, [&](double r) { return branch_faces(r, s); });
  expect_fractions({240, 240, 240, 223, 153, 35, 0}, [&](double r) { return branch_lines(r, s); });
  expect_fractions({17736, 14580, 0, 0, 0, 0, 0}, [&](double r) { return twig_faces(r, s); });
  expect_fractions({5912, 5912, 5363, 2648, 0, 0, 0}, [&](double r) { return twig_lines(r, s); });
  expect_fractions({53248, 53248, 49800, 28200, 0, 0, 0}, [&](double r) { return leaf_faces(r, d); });
  expect_fractions({13312, 13312, 13312, 13312, 11944}, [&](double r) { return leaf_points(r, d); });
  // The table and the paper's own formulas part at 600 m: trunk 760 against 720, far points 1664 against one of four
  expect_fractions({1440, 1440, 1440, 1440, 1440, 720, 0}, [&](double r) { return trunk_faces(r); });
  EXPECT_EQ(leaf_points(600, d), 0.25);
  EXPECT_EQ(leaf_points(1200, d), 0.25);
}

TEST(PlantDetail, TheEffectiveRangeIsMetresForAThousandLinesOfSixtyDegrees) {
  for (double r : ranges) EXPECT_NEAR(degradation::effective_range(r * to_radians(60) / 1000), r, 1e-9);
}

struct Drawn {
  double leaves = 0, leaf_area = 0, faces = 0;
};

Drawn drawn_at(double range) {
  const double footprint = range * to_radians(60) / 1000;
  const auto model = tree_model(fmt::format(R"("species": "quaking_aspen", "footprint": {})", footprint), 1);
  const Mesh mesh = grown(*model, model->levels());
  Drawn d;
  d.faces = mesh.face_count();
  std::set<std::uint32_t> leaves;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const FaceOrigin& origin = mesh.origins[mesh.face_origins[f]];
    if (origin.symbol < 0 || origin.parameters[1] < 0.1f || origin.parameters[2] != 0) continue;
    leaves.insert(mesh.face_origins[f]);
    d.leaf_area += 0.5 * length(newell_normal(mesh, f));
  }
  d.leaves = double(leaves.size());
  return d;
}

TEST(PlantDetail, ATreeThinsAndKeepsItsFoliage) {
  const Drawn full = drawn_at(0);
  EXPECT_NEAR(full.leaves, 22500, 1000);
  double faces = full.faces;
  for (const double range : {30.0, 120.0, 240.0, 600.0, 2000.0, 8000.0}) {
    const Drawn d = drawn_at(range);
    const double share = kept_share(parameters_of(R"("species": "quaking_aspen")"), 3, range * to_radians(60) / 1000);
    EXPECT_LE(share, degradation::leaf_points(range, 200));
    EXPECT_NEAR(d.leaves / full.leaves, share, 0.02 + 0.1 * share) << range;
    EXPECT_LE(d.faces, faces) << range;
    faces = d.faces;
  }
}

TEST(PlantDetail, FromCloseByNothingIsMissing) {
  const Drawn full = drawn_at(0);
  for (const double range : {0.5, 5.0, 15.0})
    EXPECT_NEAR(drawn_at(range).leaves, full.leaves, 0.01 * full.leaves) << range;
}

// As long as no leaf is left out no stem is, however few leaves stems bear; and there are fewer of them where leaves
// are.
TEST(PlantDetail, StemsAreLeftOutWhereLeavesAre) {
  std::vector<WeberPennParameters> plants;
  for (const PlantSpecies& species : plant_species()) plants.push_back(species.parameters);
  plants.push_back(parameters_of(R"("levels": 2, "branches": [null, 15], "leaves": -7, "leaf_scale": 0.3)"));
  plants.push_back(parameters_of(R"("levels": 4, "branches": [null, 5, 0.5, 2], "leaves": 0.5)"));
  for (const WeberPennParameters& p : plants)
    for (int level = 1; level < p.levels; ++level) {
      double before = 1;
      for (double footprint = 1e-4; footprint < 0.3; footprint *= 1.3) {
        const double share = kept_share(p, level, footprint), leaves = kept_share(p, p.levels, footprint);
        EXPECT_TRUE(share == 1 || leaves < 1) << level << ' ' << footprint << ": " << share;
        EXPECT_LE(share, before) << level << ' ' << footprint;
        before = share;
      }
    }
}

// What is asked of many stems at once is what is asked of each.
TEST(PlantDetail, SharesOfAFootprintServeAllStems) {
  for (const PlantSpecies& species : plant_species()) {
    const WeberPennParameters& p = species.parameters;
    for (const double footprint : {0.0, 0.002, 0.05, 1.0}) {
      const KeptShares shares(p, footprint);
      EXPECT_EQ(shares.footprint(), footprint);
      EXPECT_EQ(shares.of(0), 1);
      for (int level = 0; level < p.levels; ++level) {
        EXPECT_EQ(shares.of(level + 1), kept_share(p, level + 1, footprint));
        const PlantDetail one = plant_detail(p, level, 0.1, 0.5, footprint, true),
                          of_many = plant_detail(p, level, 0.1, 0.5, shares, true);
        EXPECT_EQ(one.child_share, of_many.child_share);
        EXPECT_EQ(one.stem_share, of_many.stem_share);
        EXPECT_EQ(one.leaf_length, of_many.leaf_length);
        EXPECT_EQ(one.stem.sides, of_many.stem.sides);
      }
    }
    EXPECT_LT(KeptShares(p, 1).of(p.levels), KeptShares(p, 0.002).of(p.levels)) << species.name;
  }
}

std::uint64_t final_faces(const Model& model, CellMesh cell, int level) {
  const Expansion e = expand(model, std::move(cell), level);
  if (e.leaf) return e.leaf->face_count;
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < e.inner->child_count(); ++i)
    sum += final_faces(model, child_cell(model, *e.inner, i), e.inner->level);
  return sum;
}

TEST(PlantDetail, TheFurtherATreeTheFewerItsFacesDownToSomeTens) {
  for (const PlantSpecies& species : plant_species()) {
    const auto model = tree_model(fmt::format(R"("species": "{}")", species.name), 1, 1);
    for (const auto& [pixels, most] : {std::pair{40.0, 6000u}, {10.0, 1200u}, {3.0, 300u}}) {
      const ConstantFootprint seen(species.parameters.scale / pixels);
      const std::uint64_t faces = final_faces(*model, root_cell(*model, &seen), 0);
      EXPECT_LE(faces, most) << species.name << " " << pixels;
      EXPECT_GE(faces, 12u) << species.name << " " << pixels;
    }
  }
}

}  // namespace
}  // namespace meristem::test
