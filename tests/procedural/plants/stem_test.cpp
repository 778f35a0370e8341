// Skeletons: numbers of stems, lengths, angles, and that children sit on their parents.
#include "tests/procedural/plants/plant_support.h"

#include <gtest/gtest.h>

namespace meristem::test {
namespace {

std::string named(const char* species) { return std::string("\"species\": \"") + species + "\""; }

// Mean numbers of stems by level, then of leaves, over trees without splitting and pruning. Of the last level only
// every `sample`-th stem's leaves are counted.
std::vector<double> mean_counts(const char* species, int trees, int sample) {
  WeberPennParameters p =
      parameters_of(named(species) + R"(, "seg_splits": [0, 0, 0], "base_splits": 0, "prune_ratio": 0)");
  std::vector<double> counts(std::size_t(p.levels) + 1, 0.0);
  std::vector<StemChild> children;
  for (int tree = 0; tree < trees; ++tree) {
    int index = 0;
    for_each_stem(p, trunk_of(p, hash_keys(7, Key(tree))), [&](const Stem& stem) {
      counts[std::size_t(stem.bud().level)] += 1.0 / trees;
      if (!stem.bears_leaves() || index++ % sample != 0) return;
      stem.find_children(children);
      counts.back() += double(children.size()) * sample / trees;
    });
  }
  return counts;
}

void expect_within_2_percent(const std::vector<double>& counts, const std::vector<double>& expected) {
  ASSERT_EQ(counts.size(), expected.size());
  for (std::size_t i = 0; i < counts.size(); ++i) EXPECT_NEAR(counts[i], expected[i], 0.02 * expected[i]) << i;
}

TEST(Stem, CountsByLevelAreThoseOfTheSpecification) {
  expect_within_2_percent(mean_counts("quaking_aspen", 100, 10), {1, 50, 1200, 22500});
  expect_within_2_percent(mean_counts("black_tupelo", 100, 20), {1, 50, 1000, 9000, 40500});
  expect_within_2_percent(mean_counts("california_black_oak", 100, 20), {1, 40, 3684, 69100});
  expect_within_2_percent(mean_counts("weeping_willow", 4, 50), {1, 25, 250, 56250, 633000});
}

TEST(Stem, SplittingKeepsTheNumberOfChildren) {
  WeberPennParameters p = parameters_of(named("weeping_willow") + R"(, "prune_ratio": 0)");
  double branches = 0, twigs = 0;
  std::vector<StemChild> children;
  for (Key tree = 0; tree < 100; ++tree) {
    const Stem trunk(p, trunk_of(p, tree));
    trunk.find_children(children);
    branches += double(children.size()) / 100;
    const std::vector<StemChild> own = children;
    for (const StemChild& c : own) {
      Stem(p, c.bud).find_children(children);
      twigs += double(children.size()) / 100;
    }
  }
  EXPECT_NEAR(branches, 25, 0.5);
  EXPECT_NEAR(twigs, 250, 5);
}

TEST(Stem, SplitsFollowTheirRate) {
  // 19 forks of 0.1 clones each on average; a stem that has split goes on at half the rate, and again: more tips than
  // at a quarter of the rate all along, fewer than without halving (1.1^19 = 6.1)
  const WeberPennParameters p = parameters_of(R"("seg_splits": [0.1], "curve_res": [20])");
  double tips = 0;
  for (Key tree = 0; tree < 400; ++tree) {
    const Stem trunk(p, trunk_of(p, tree));
    for (const StemPiece& piece : trunk.pieces()) tips += piece.next.empty() ? 1.0 / 400 : 0;
  }
  EXPECT_GT(tips, 1.6);  // 1.025^19
  EXPECT_LT(tips, 6.1);
}

TEST(Stem, LengthsFollowTheCrownsShape) {
  const WeberPennParameters p = parameters_of(named("quaking_aspen"));
  const Stem trunk(p, trunk_of(p, 3));
  EXPECT_GE(trunk.bud().length, 10);
  EXPECT_LE(trunk.bud().length, 16);
  EXPECT_NEAR(trunk.bud().radius, 0.015 * trunk.bud().length, 1e-12);
  std::vector<StemChild> children;
  trunk.find_children(children);
  for (const StemChild& c : children) {
    const double height = trunk.bud().length - (trunk.bud().length - 0.4 * trunk.bud().scale) * (1 - c.place);
    EXPECT_NEAR(c.bud.frame.origin.y, height, 0.1 * trunk.bud().length);  // the trunk bends a little
    EXPECT_NEAR(c.bud.length, 0.3 * trunk.bud().length * shape_ratio(7, 1 - c.place), 1e-9);
  }
}

TEST(Stem, DownAnglesVaryAlongTheTrunkAsThePicturesShow) {
  // Aspen: 110 degrees at the crown's base to 30 at the tip
  const WeberPennParameters p = parameters_of(named("quaking_aspen") + R"(, "curve_v": [0], "bend_v": [0])");
  const Stem trunk(p, trunk_of(p, 5));
  std::vector<StemChild> children;
  trunk.find_children(children);
  const auto down = [&](const StemChild& c) { return to_degrees(declination(c.bud.frame.z)); };
  for (const StemChild& c : children) EXPECT_NEAR(down(c), 60 - 50 * (1 - 2 * shape_ratio(0, 1 - c.place)), 1e-6);
  EXPECT_GT(down(children.front()), 107);
  EXPECT_LT(down(children.back()), 33);
}

TEST(Stem, ChildrenSitOnTheAxisAndAreNoThickerThanTheirParent) {
  for (const PlantSpecies& species : plant_species()) {
    const WeberPennParameters& p = species.parameters;
    std::vector<StemChild> children;
    const auto check = [&](const Stem& stem) {
      stem.find_children(children);
      for (const StemChild& c : children) {
        double nearest = INFINITY;
        for (const StemPiece& piece : stem.pieces())
          for (std::size_t i = 0; i + 1 < piece.nodes.size(); ++i)
            for (double t = 0; t <= 1; t += 1.0 / 64)
              nearest = std::min(nearest, length(stem.position(piece, i, t) - c.bud.frame.origin));
        ASSERT_LT(nearest, stem.bud().length / 32) << species.name;
        ASSERT_LE(c.bud.radius, stem.bud().radius) << species.name;
        ASSERT_NEAR(length(c.bud.frame.z), 1, 1e-9);
        ASSERT_NEAR(dot(c.bud.frame.x, c.bud.frame.z), 0, 1e-9);
      }
    };
    const Stem trunk(p, trunk_of(p, 11));
    check(trunk);
    trunk.find_children(children);
    if (!children.empty()) check(Stem(p, StemBud(children[children.size() / 2].bud)));
  }
}

TEST(Stem, ATreeIsTheSameForTheSameKeyAndAnotherForAnother) {
  const WeberPennParameters p = parameters_of(named("california_black_oak"));
  const Stem a(p, trunk_of(p, 1)), b(p, trunk_of(p, 1)), c(p, trunk_of(p, 2));
  ASSERT_EQ(a.pieces().size(), b.pieces().size());
  for (std::size_t i = 0; i < a.pieces().size(); ++i)
    EXPECT_EQ(a.pieces()[i].nodes.back().frame, b.pieces()[i].nodes.back().frame);
  EXPECT_NE(a.bud().length, c.bud().length);
}

TEST(Stem, AttractionBendsUpwardsOrDown) {
  const auto tip_height = [](const std::string& attraction) {
    const WeberPennParameters p = parameters_of(
        R"("curve": [0, 0, 0], "curve_v": [0, 0, 0], "bend_v": [0, 0, 0], "curve_res": [1, 1, 8], "attraction_up": )" +
        attraction);
    // A level stem with y to the sky
    const StemBud bud{2, 1, {{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}, {}}, 1, 0.01, 0, 0, 10};
    return Stem(p, bud).pieces().back().nodes.back();
  };
  EXPECT_NEAR(tip_height("0").frame.origin.y, 0, 1e-12);
  EXPECT_GT(tip_height("1").frame.origin.y, 0.3);
  EXPECT_GT(tip_height("1").frame.z.y, 0.7);
  EXPECT_LE(tip_height("1").frame.z.y, 1);
  EXPECT_LT(tip_height("-1").frame.origin.y, -0.3);
}

TEST(Stem, HelicesKeepTheirDeclination) {
  const WeberPennParameters p = parameters_of(R"("curve_v": [0, -30], "curve_res": [3, 4])");
  const StemBud bud{1, 9, {}, 2, 0.01, 0, 0, 10};
  const Stem stem(p, bud);
  const StemPiece& piece = stem.pieces().front();
  for (const StemNode& n : piece.nodes) EXPECT_NEAR(to_degrees(std::acos(dot(n.frame.z, bud.frame.z))), 30, 1e-6);
  // Half a turn for each segment: four make two turns, and it ends over its root
  const Vec3d end = piece.nodes.back().frame.origin;
  EXPECT_NEAR(std::hypot(end.x, end.y), 0, 1e-9);
  EXPECT_NEAR(end.z, 2 * std::cos(to_radians(30)), 1e-9);
}

TEST(Stem, PrunedStemsLieInTheEnvelope) {
  const WeberPennParameters p = parameters_of(named("weeping_willow"));
  const Stem trunk(p, trunk_of(p, 2));
  std::vector<StemChild> children;
  trunk.find_children(children);
  int inside = 0, all = 0;
  for (const StemChild& c : children) {
    const Stem branch(p, c.bud);
    EXPECT_LE(branch.bud().length, c.bud.length);
    bool fits = true;
    for (const StemPiece& piece : branch.pieces())
      for (const StemNode& n : piece.nodes)
        fits = fits && std::hypot(n.frame.origin.x, n.frame.origin.z) <= 0.4 * trunk.bud().scale;
    inside += fits;
    ++all;
  }
  EXPECT_GT(inside, 0.9 * all);  // a stump may stick out
}

}  // namespace
}  // namespace meristem::test
