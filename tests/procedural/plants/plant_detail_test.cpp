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

TEST(PlantDetail, ATreeThinsByTheTableAndKeepsItsCover) {
  const Drawn full = drawn_at(0);
  EXPECT_NEAR(full.leaves, 22500, 1000);
  double faces = full.faces;
  for (const double range : {30.0, 120.0, 240.0, 600.0, 2000.0}) {
    const Drawn d = drawn_at(range);
    const double share = range <= 600 ? degradation::leaf_points(range, 200) : 1.0 / 9;
    EXPECT_NEAR(d.leaves / full.leaves, share, 0.03) << range;
    EXPECT_NEAR(d.leaf_area / full.leaf_area, 1, 0.1) << range;
    EXPECT_LE(d.faces, faces) << range;
    faces = d.faces;
  }
  EXPECT_LT(faces, 0.06 * full.faces);
}

}  // namespace
}  // namespace meristem::test
