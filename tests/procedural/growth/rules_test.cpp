#include "tests/procedural/growth/derivation.h"

#include <gtest/gtest.h>

namespace meristem::test {
namespace {

using Messages = std::vector<std::string>;

Messages messages_of(const std::string& step, const std::string& base = R"json({ "type": "box" })json") {
  return Derivation(base, {step}).messages();
}

TEST(Rules, RightOnesRaiseNothing) {
  EXPECT_EQ(
      messages_of(R"json({ "grow": 2, "rules": { "a( p , q)": { "weight": 2, "template": "segment", "length": "p*(q+1)",
    "faces": { "cap": "a( max(p, 0.5), q*0.5 )", "side": "b" } }, "b": { "template": "box", "faces": {
    "side": "c()" } } } })json",
                  R"json({ "type": "box", "top": "a(1, 2)" })json"),
      Messages{});
}

TEST(Rules, UnknownTemplatesAreNamedWithTheNearest) {
  EXPECT_EQ(messages_of(R"json({ "grow": 1, "rules": { "a": { "template": "segmnt" } } })json"),
            (Messages{"1:44 no template named \"segmnt\"; did you mean \"segment\"?; known: box, extrude, fork, leaf, "
                      "mesh, segment, spike, tent"}));
}

TEST(Rules, UnknownFacesAndKeysAreNamedWithTheNearest) {
  EXPECT_EQ(
      messages_of(R"json({ "grow": 1, "rules": { "a": { "template": "segment", "faces": { "cpa": "a" } } } })json"),
      (Messages{"1:66 the template has no face named \"cpa\"; did you mean \"cap\"?; known: side, cap"}));
  const Messages list =
      messages_of(R"json({ "grow": 1, "rules": { "a": { "template": "segment", "lenght": 2 } } })json");
  ASSERT_EQ(list.size(), 1u);
  EXPECT_NE(list[0].find("\"length\""), std::string::npos) << list[0];
}

TEST(Rules, NumbersOfParametersMustAgree) {
  EXPECT_EQ(messages_of("{ \"grow\": 1, \"rules\": { \"a(p)\": { \"template\": \"segment\",\n \"faces\": { \"cap\": "
                        "\"a(p, 1)\" } } } }"),
            (Messages{"2:21 symbol \"a\" has 2 parameters here, but 1 in line 1"}));
  EXPECT_EQ(messages_of(R"json({ "grow": 1, "rules": { "a(p)": { "template": "segment" } } })json",
                        R"json({ "type": "box", "top": "a" })json"),
            (Messages{"1:26 symbol \"a\" has 0 parameters here, but 1 in line 1"}));
  EXPECT_EQ(messages_of(R"json({ "grow": 1, "rules": { "a(b,c,d,e,f,g,h,i,j)": { "template": "segment" } } })json"),
            (Messages{"1:26 symbol \"a\" has 9 parameters; at most 8 are possible"}));
}

TEST(Rules, HeadsAndSuccessorsThatAreNoSymbols) {
  EXPECT_EQ(messages_of(R"json({ "grow": 1, "rules": { "a(p": { "template": "segment" } } })json"),
            (Messages{"1:29 expected \")\""}));
  EXPECT_EQ(messages_of(R"json({ "grow": 1, "rules": { "a(p, p)": { "template": "segment" } } })json"),
            (Messages{"1:31 a parameter's name stands twice: \"p\""}));
  EXPECT_EQ(messages_of(R"json({ "grow": 1, "rules": { "a(radius)": { "template": "segment" } } })json"),
            (Messages{"1:28 every rule has a variable of that name already: \"radius\""}));
  EXPECT_EQ(
      messages_of(R"json({ "grow": 1, "rules": { "a": { "template": "segment", "faces": { "cap": "3" } } } })json"),
      (Messages{"1:74 expected the name of a symbol, such as \"shoot(1)\""}));
  EXPECT_EQ(messages_of(
                R"json({ "grow": 1, "rules": { "a": { "template": "segment", "faces": { "cap": "b(1,,2)" } } } })json"),
            (Messages{"1:78 a parameter is missing here"}));
  EXPECT_EQ(messages_of(
                R"json({ "grow": 1, "rules": { "a": { "template": "segment", "faces": { "cap": "b(1) c" } } } })json"),
            (Messages{"1:79 expected the end of the text behind a symbol's parameters"}));
}

TEST(Rules, LightHasADirection) {
  EXPECT_EQ(messages_of(R"json({ "grow": 1, "light": [0, 0, 0], "rules": {} })json"),
            (Messages{"1:23 a direction of light has a length"}));
  EXPECT_EQ(messages_of(R"json({ "grow": 1, "rules": { "a(light)": { "template": "segment" } } })json"),
            (Messages{"1:28 every rule has a variable of that name already: \"light\""}));
}

TEST(Rules, ErrorsInExpressionsPointInside) {
  const Messages list = messages_of(
      R"json({ "grow": 1, "rules": { "a(len)": { "template": "segment", "faces": { "cap": "a(0.5*lem)" } } } })json");
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0].substr(0, 5), "1:85 ") << list[0];
  EXPECT_NE(list[0].find("len"), std::string::npos) << list[0];
}

TEST(Rules, TerminalsNearASymbolWithRulesAreSuspicious) {
  const Derivation d(R"json({ "type": "box", "top": "shoot" })json",
                     {R"json({ "grow": 1, "rules": { "shoot": { "template": "segment", "faces": { "cap": "shot",
    "side": "bark" } } } })json"});
  EXPECT_EQ(d.messages(), (Messages{"1:78 symbol \"shot\" has no rule in any step; did you mean \"shoot\"?"}));
  EXPECT_FALSE(d.diagnostics.has_errors());
}

TEST(Rules, WhatNoFaceCanMeetIsSaid) {
  const auto warnings = [](const std::string& rules) {
    Derivation d(R"json({ "type": "box", "top": "shoot" })json", {R"({ "grow": 0, "rules": {)" + rules + "} }"});
    EXPECT_FALSE(d.diagnostics.has_errors());
    for (const FaceOrigin& origin : d.base.origins)
      if (origin.symbol >= 0) d.symbols->put_on_base(origin.symbol);
    d.symbols->report_unreachable(d.diagnostics);
    return d.messages();
  };
  const std::string text = R"json(
    "shoot": { "template": "segment", "faces": { "cap": "tip" } },
    "shoots": { "template": "segment", "faces": { "cap": "thorn" } },
    "thorn": { "template": "spike" }, "tip": { "template": "segment", "faces": { "side": "shoot" } })json";
  EXPECT_EQ(warnings(text),
            (Messages{"3:6 no face ever carries \"shoots\": neither the base nor a rule that is reached "
                      "makes it; did you mean \"shoot\"?"}))
      << "and not that thorns come of these alone";
  EXPECT_EQ(warnings(R"json( "shoot": { "template": "spike" },
    "ebb": { "template": "segment", "faces": { "cap": "flow" } },
    "flow": { "template": "segment", "faces": { "cap": "ebb", "side": "flow" } } )json"),
            (Messages{"2:6 no face ever carries \"ebb\": neither the base nor a rule that is reached makes it"}));
  EXPECT_EQ(warnings(R"json( "shoot": { "if": "0", "template": "segment", "faces": { "cap": "rest" } },
    "rest": { "template": "spike" } )json"),
            Messages{})
      << "conditions may be switched";
}

TEST(Rules, StepsAndRulesHaveTheirForms) {
  EXPECT_EQ(messages_of(R"json({ "grow": 1, "rules": 3 })json"),
            (Messages{"1:23 expected an object: symbols and their rules; found a number"}));
  EXPECT_EQ(messages_of(R"json({ "grow": 1, "rules": { "a": [] } })json"),
            (Messages{"1:30 a symbol needs at least one rule"}));
  EXPECT_EQ(messages_of(R"json({ "grow": 1, "rules": { "a": 3 } })json"),
            (Messages{"1:30 expected a rule as an object, found a number"}));
  EXPECT_EQ(messages_of(R"json({ "grow": 65, "rules": { "a": { "template": "segment" } } })json").size(), 1u);
  EXPECT_EQ(messages_of(R"json({ "grow": 1 })json").size(), 1u);
}

TEST(Rules, ASymbolMayGrowInLaterStepsAlone) {
  const Derivation d(
      octagon,
      {R"json({ "grow": 1, "rules": { "shoot(l)": { "template": "segment", "faces": { "side": "thorn(l)" } } } })json",
       R"json({ "grow": 1, "rules": { "thorn(l)": { "template": "spike", "length": "l" } } })json"});
  EXPECT_EQ(d.messages(), Messages{});
  EXPECT_EQ(d.grown(1).mesh.face_count(), 18u);
  EXPECT_EQ(d.grown(2).mesh.face_count(), 18u + 8 * 3);
  EXPECT_FALSE(d.steps[0]->grows(d.symbols->find("thorn")));
  EXPECT_TRUE(d.steps[1]->grows(d.symbols->find("thorn")));
}

TEST(Rules, VariablesDescribeTheReplacedFace) {
  const Derivation d(R"json({ "type": "box", "size": [2, 4, 6], "top": "a", "side": "a", "bottom": "a" })json",
                     {R"json({ "grow": 1, "rules": { "a": { "template": "extrude",
                        "faces": { "cap":
      "told(up, frame_z[2], dot(frame_x, frame_y), P[1], radius, u, v, level)" } } } })json"});
  ASSERT_EQ(d.messages(), Messages{});
  const Mesh mesh = d.grown();
  int up_faces = 0;
  for (std::uint32_t f : faces_with(mesh, d.symbols->find("told"))) {
    const auto& p = mesh.origins[mesh.face_origins[f]].parameters;
    const FaceFrame frame = face_frame(mesh, f);  // the cap is parallel to the replaced face
    EXPECT_NEAR(p[0], frame.z.y, 1e-6);
    EXPECT_NEAR(p[1], frame.z.z, 1e-6);
    EXPECT_NEAR(p[2], 0, 1e-6);
    EXPECT_NEAR(p[3], frame.origin.y, 1e-6);
    EXPECT_NEAR(p[4], frame.radius / 0.8, 1e-5);
    EXPECT_NEAR(p[5], 0.5, 1e-6);
    EXPECT_NEAR(p[6], frame.origin.y, 1e-6);
    EXPECT_EQ(p[7], 0);
    up_faces += p[0] > 0.5f;
  }
  EXPECT_EQ(up_faces, 1);
}

TEST(Rules, ManualPagesCoverStepRuleAndTemplates) {
  EXPECT_EQ(grow_step_info().describe().size(), 4u);
  EXPECT_EQ(Production::info().describe().size(), 6u);
  for (const ComponentInfo& info : templates().infos()) EXPECT_GE(info.describe().size(), 2u) << info.name;
  for (const ComponentInfo& info : bases().infos()) EXPECT_GE(info.describe().size(), 2u) << info.name;
}

}  // namespace
}  // namespace meristem::test
