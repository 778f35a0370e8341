// Parameters and formulas against the paper's tables, and against the errors a user may make.
#include "tests/procedural/plants/plant_support.h"

#include <gtest/gtest.h>

namespace meristem::test {
namespace {

// The appendix of the paper, in its order, for one tree.
struct Table {
  const char* name;
  std::vector<double> tree;                // Shape BaseSize Scale ScaleV ZScale ZScaleV Levels Ratio RatioPower Lobes
                                           // LobeDepth Flare 0Scale 0ScaleV 0BaseSplits
  std::vector<std::vector<double>> level;  // DownAngle V Rotate V Branches Length V Taper SegSplits SplitAngle V
                                           // CurveRes Curve CurveBack CurveV
  std::vector<double> leaves;              // Leaves LeafShape LeafScale LeafScaleX AttractionUp PruneRatio PruneWidth
                                           // Peak PowerLow PowerHigh
};

const Table tables[] = {
    {"quaking_aspen",
     {7, 0.4, 13, 3, 1, 0, 3, 0.015, 1.2, 5, 0.07, 0.6, 1, 0, 0},
     {{0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 3, 0, 0, 20},
      {60, -50, 140, 0, 50, 0.3, 0, 1, 0, 0, 0, 5, -40, 0, 50},
      {45, 10, 140, 0, 30, 0.6, 0, 1, 0, 0, 0, 3, -40, 0, 75},
      {45, 10, 77, 0, 10, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}},
     {25, 0, 0.17, 1, 0.5, 0, 0.5, 0.5, 0.5, 0.5}},
    {"black_tupelo",
     {4, 0.2, 23, 5, 1, 0, 4, 0.015, 1.3, 3, 0.1, 1, 1, 0, 0},
     {{0, 0, 0, 0, 0, 1, 0, 1.1, 0, 0, 0, 10, 0, 0, 40},
      {60, -40, 140, 0, 50, 0.3, 0.05, 1, 0, 0, 0, 10, 0, 0, 90},
      {30, 10, 140, 0, 25, 0.6, 0.1, 1, 0, 0, 0, 10, -10, 0, 150},
      {45, 10, 140, 0, 12, 0.4, 0, 1, 0, 0, 0, 1, 0, 0, 0}},
     {6, 0, 0.3, 0.5, 0.5, 0, 0.5, 0.5, 0.5, 0.5}},
    {"weeping_willow",
     {3, 0.05, 15, 5, 1, 0, 4, 0.03, 2, 9, 0.03, 0.75, 1, 0, 2},
     {{0, 0, 0, 0, 0, 0.8, 0, 1, 0.1, 3, 0, 8, 0, 20, 120},
      {20, 10, -120, 30, 25, 0.5, 0.1, 1, 0.2, 30, 10, 16, 40, 80, 90},
      {30, 10, -120, 30, 10, 1.5, 0, 1, 0.2, 45, 20, 12, 0, 0, 0},
      {20, 10, 140, 0, 300, 0.1, 0, 1, 0, 0, 0, 1, 0, 0, 0}},
     {15, 0, 0.12, 0.2, -3, 1, 0.4, 0.6, 0.001, 0.5}},
    {"california_black_oak",
     {2, 0.05, 10, 10, 1, 0, 3, 0.018, 1.3, 5, 0.1, 1.2, 1, 0, 2},
     {{0, 0, 0, 0, 0, 1, 0, 0.95, 0.4, 10, 0, 8, 0, 0, 90},
      {30, -30, 80, 0, 40, 0.8, 0.1, 1, 0.2, 10, 10, 10, 40, -70, 150},
      {45, 10, 140, 0, 120, 0.2, 0.05, 1, 0.1, 10, 10, 3, 0, 0, -30},
      {45, 10, 140, 0, 0, 0.4, 0, 1, 0, 0, 0, 1, 0, 0, 0}},
     {25, 0, 0.12, 0.66, 0.8, 0, 0.5, 0.5, 0.5, 0.5}},
};

TEST(WeberPennParameters, SpeciesHaveTheValuesOfTheAppendix) {
  for (const Table& t : tables) {
    SCOPED_TRACE(t.name);
    const WeberPennParameters p = parameters_of(std::string("\"species\": \"") + t.name + "\"");
    EXPECT_EQ(t.tree, (std::vector<double>{double(p.shape), p.base_size, p.scale, p.scale_v, p.z_scale, p.z_scale_v,
                                           double(p.levels), p.ratio, p.ratio_power, double(p.lobes), p.lobe_depth,
                                           p.flare, p.trunk_scale, p.trunk_scale_v, double(p.base_splits)}));
    for (std::size_t n = 0; n < 4; ++n) {
      const PlantLevel& l = p.level[n];
      EXPECT_EQ(t.level[n], (std::vector<double>{l.down_angle, l.down_angle_v, l.rotate, l.rotate_v, l.branches,
                                                 l.length, l.length_v, l.taper, l.seg_splits, l.split_angle,
                                                 l.split_angle_v, l.curve_res, l.curve, l.curve_back, l.curve_v}))
          << "level " << n;
    }
    EXPECT_EQ(t.leaves, (std::vector<double>{p.leaves, double(p.leaf_shape), p.leaf_scale, p.leaf_scale_x,
                                             p.attraction_up, p.prune_ratio, p.prune_width, p.prune_width_peak,
                                             p.prune_power_low, p.prune_power_high}));
  }
}

TEST(WeberPennParameters, TheSceneSaysWhatTheSpeciesDoesNot) {
  const WeberPennParameters p = parameters_of(R"("species": "black_tupelo", "shape": "conical", "leaves": 9,
      "length": [0.9, null, 0.5], "curve_res": [4])");
  EXPECT_EQ(p.shape, 0);
  EXPECT_EQ(p.leaves, 9);
  EXPECT_EQ(p.level[0].length, 0.9);
  EXPECT_EQ(p.level[1].length, 0.3);
  EXPECT_EQ(p.level[2].length, 0.5);
  EXPECT_EQ(p.level[3].length, 0.4);
  EXPECT_EQ(p.level[0].curve_res, 4);
  EXPECT_EQ(p.level[1].curve_res, 10);
  EXPECT_EQ(p.scale, 23);
}

TEST(WeberPennParameters, MistakesAreReportedWhereTheyStand) {
  const auto message = [](const std::string& members) {
    const Value value = JsonText("{" + members + "}").read();
    Diagnostics diagnostics;
    Params params(value, "base \"weber_penn\"", diagnostics);
    read_weber_penn(params);
    params.finish();
    return diagnostics.list().empty() ? std::string() : diagnostics.list().front().message;
  };
  EXPECT_NE(message(R"("length": [1, 2, 3, 4, 5])").find("1 to 4 numbers"), std::string::npos);
  EXPECT_NE(message(R"("taper": [1, 4])").find("of level 1: expected a number, 0 to 3"), std::string::npos);
  EXPECT_NE(message(R"("scale": 3, "scale_v": 4)").find("is possible"), std::string::npos);
  EXPECT_NE(message(R"("length": [0])").find("no length"), std::string::npos);
  EXPECT_NE(message(R"("species": "aspen")").find("quaking_aspen"), std::string::npos);
  EXPECT_NE(message(R"("down_angel": [1])").find("down_angle"), std::string::npos);
  EXPECT_EQ(message(R"("down_angle": [1])"), "");
}

TEST(WeberPennParameters, ShapeRatios) {
  const double expected[8][3] = {
      {0.2, 0.6, 1},     {0.2, 1, 0.2}, {0.2, 0.2 + 0.8 * std::sqrt(0.5), 1}, {1, 1, 1}, {0.5, 0.75, 1},
      {0, 0.5 / 0.7, 0}, {1, 0.6, 0.2}, {0.5, 0.5 + 0.25 / 0.7, 0.5}};
  for (int shape = 0; shape < 8; ++shape)
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(shape_ratio(shape, 0.5 * i), expected[shape][i], 1e-12) << shape << " " << i;
}

TEST(WeberPennParameters, TheEnvelopeIsContinuousAtItsPeak) {
  WeberPennParameters p;
  for (double peak : {0.2, 0.5, 0.6, 0.9}) {
    p.prune_width_peak = peak;
    EXPECT_NEAR(prune_shape_ratio(p, 1 - peak - 1e-9), 1, 1e-4);
    EXPECT_NEAR(prune_shape_ratio(p, 1 - peak + 1e-9), 1, 1e-4);
    for (double r = 0; r <= 1; r += 0.01) EXPECT_LE(prune_shape_ratio(p, r), 1);
  }
  EXPECT_EQ(prune_shape_ratio(p, -0.1), 0);
  EXPECT_EQ(prune_shape_ratio(p, 1.1), 0);
}

TEST(WeberPennParameters, Tapers) {
  const double length = 10, radius = 1;
  const auto at = [&](double taper, double z) { return tapered_radius(taper, length, radius, z); };
  EXPECT_EQ(at(0, 0.7), 1);                         // a cylinder
  EXPECT_NEAR(at(1, 0.7), 0.3, 1e-12);              // a cone
  EXPECT_NEAR(at(0.5, 1), 0.5, 1e-12);              // a truncated one
  EXPECT_NEAR(at(2, 0.5), 1, 1e-12);                // a cylinder ...
  EXPECT_NEAR(at(2, 0.95), std::sqrt(0.75), 1e-9);  // ... with a round end
  EXPECT_NEAR(at(2, 1), 0, 1e-9);
  for (double z = 0; z <= 1; z += 0.2) EXPECT_NEAR(at(3, z), 0, 1e-6) << z;        // between spheres
  for (double z = 0.1; z <= 1; z += 0.2) EXPECT_NEAR(at(3, z), 1, 1e-6) << z;      // their equators
  for (double z = 0.1; z <= 0.8; z += 0.2) EXPECT_NEAR(at(2.2, z), 1, 1e-6) << z;  // the cactus of the plates
  for (double z = 0.2; z <= 0.8; z += 0.2) EXPECT_NEAR(at(2.2, z), 0.8, 1e-6) << z;
}

}  // namespace
}  // namespace meristem::test
