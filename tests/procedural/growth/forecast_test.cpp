#include "procedural/growth/forecast.h"

#include "tests/procedural/growth/derivation.h"

#include <gtest/gtest.h>

namespace meristem::test {
namespace {

double forecast(Derivation& d) {
  std::vector<std::unique_ptr<Step>> steps;
  for (auto& step : d.steps) steps.push_back(std::move(step));
  return estimated_faces(d.base, extent_of(d.base), steps);
}

std::vector<std::string> corner_messages(Derivation& d) {
  std::vector<std::unique_ptr<Step>> steps;
  for (auto& step : d.steps) steps.push_back(std::move(step));
  check_corner_counts(d.base, steps, std::vector<Location>(steps.size()), d.diagnostics);
  return d.messages();
}

TEST(Forecast, IsExactForCertainRules) {
  Derivation d(octagon, {R"json({ "grow": 5, "rules": { "shoot(l)": { "template": "fork", "faces": { "left": "shoot(l)",
    "right": "shoot(l)" } } } })json"});
  const double truth = d.grown().face_count();
  EXPECT_EQ(forecast(d), truth);
}

TEST(Forecast, IsTheMeanForConstantWeights) {
  // Each step every shoot becomes 1 or 2 with 16 sides or 8 more, at even odds: 1.5^n shoots after n steps
  const std::string rules =
      R"json({ "grow": 4, "rules": { "shoot(l)": [ { "template": "fork", "faces": { "left": "shoot(l)",
    "right": "shoot(l)" } },
                                { "template": "segment", "faces": { "cap": "shoot(l)" } } ] } })json";
  Derivation d(octagon, {rules});
  double sum = 0;
  for (Key seed = 0; seed < 300; ++seed) sum += Derivation(octagon, {rules}, seed).grown().face_count();
  EXPECT_NEAR(forecast(d), sum / 300, 0.05 * sum / 300);
}

TEST(Forecast, SelfRecursionIsBoundedByTheStepsAndSeenBeforehand) {
  Derivation d(octagon,
               {R"json({ "grow": 64, "rules": { "shoot(l)": { "template": "fork", "faces": { "left": "shoot(l)",
    "right": "shoot(l)" } } } })json"});
  EXPECT_GT(forecast(d), 1e9);
}

TEST(Forecast, ConditionsThatCannotHoldEndIt) {
  Derivation d(octagon, {R"json({ "grow": 64, "rules": { "shoot(l)": { "if": "l > 0.3", "template": "fork", "faces": {
    "left": "shoot(l/2)", "right": "shoot(l/2)" } } } })json"});
  const double truth = d.grown(3).mesh.face_count();
  EXPECT_EQ(forecast(d), truth);
}

TEST(Forecast, FindsTemplatesThatCannotStandWhereTheyWill) {
  Derivation d(R"json({ "type": "prism", "sides": 5, "cap": "a" })json",
               {R"json({ "grow": 2, "rules": { "a": { "template": "segment", "faces": { "side": "b" } },
  "b": { "template": "box", "faces": { "side": "c" } },
  "c": { "template": "fork" } } })json",
                R"json({ "grow": 1, "rules": { "b": { "template": "tent" }, "c": { "template": "tent" } } })json"});
  EXPECT_EQ(corner_messages(d), (std::vector<std::string>{}));
  Derivation e(R"json({ "type": "prism", "sides": 5, "cap": "a" })json", {R"json({ "grow": 2, "rules": { "a": [
  { "template": "segment", "faces": { "cap": "b" } } ], "b":
  { "template": "fork" } } })json"});
  EXPECT_EQ(
      corner_messages(e),
      (std::vector<std::string>{"3:3 a fork needs a face with an even number of corners, at least 4; this one has 5"}));
}

}  // namespace
}  // namespace meristem::test
