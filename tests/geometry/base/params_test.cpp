#include "geometry/base/params.h"
#include "values.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

using namespace testing;

constexpr Range angle{0, 180, "deg"};

// Reads one object, and keeps what was said about it.
struct Reading {
  explicit Reading(Value v) : value(std::move(v)), params(value, "fern \"tall\"", diagnostics) {}

  // The messages, one a line.
  std::string messages() const {
    std::string result;
    for (const Diagnostic& d : diagnostics.list()) result += d.message + "\n";
    return result;
  }

  Value value;
  Diagnostics diagnostics;
  Params params;
};

TEST(Params, ReturnsWhatIsWritten) {
  Reading r(object({{"spread", number(30)},
                    {"fronds", number(7)},
                    {"wet", boolean(true)},
                    {"label", text("x")},
                    {"kind", text("b")},
                    {"up", array({number(1), number(2), number(3)})},
                    {"grey", number(0.5)}}));
  EXPECT_EQ(r.params.real("spread", 1, angle, ""), 30);
  EXPECT_EQ(r.params.integer("fronds", 1, any_range, ""), 7);
  EXPECT_TRUE(r.params.boolean("wet", false, ""));
  EXPECT_EQ(r.params.text("label", "", ""), "x");
  EXPECT_EQ(r.params.choice("kind", 0, {"a", "b"}, ""), 1);
  EXPECT_EQ(r.params.vector("up", {}, any_range, ""), Vec3d(1, 2, 3));
  EXPECT_EQ(r.params.color("grey", {}, ""), Vec3d(0.5));
  r.params.finish();
  EXPECT_EQ(r.messages(), "");
}

TEST(Params, ReturnsDefaultsForWhatIsNotWritten) {
  Reading r(object({}));
  EXPECT_EQ(r.params.real("spread", 40, angle, ""), 40);
  EXPECT_EQ(r.params.integer("fronds", 5, any_range, ""), 5);
  EXPECT_EQ(r.params.text("label", "none", ""), "none");
  EXPECT_EQ(r.params.choice("kind", 1, {"a", "b"}, ""), 1);
  EXPECT_EQ(r.params.color("c", {1, 2, 3}, ""), Vec3d(1, 2, 3));
  EXPECT_EQ(r.params.raw("rules", false, "", ""), nullptr);
  EXPECT_FALSE(r.params.has("spread"));
  EXPECT_EQ(r.messages(), "");
}

TEST(Params, ReportsWrongTypesAndGoesOnWithTheDefault) {
  Reading r(object({{"spread", text("wide")},
                    {"wet", number(1)},
                    {"label", number(1)},
                    {"up", array({number(1)})},
                    {"c", text("red")},
                    {"kind", boolean(false)}}));
  EXPECT_EQ(r.params.real("spread", 40, angle, ""), 40);
  EXPECT_FALSE(r.params.boolean("wet", false, ""));
  EXPECT_EQ(r.params.text("label", "l", ""), "l");
  EXPECT_EQ(r.params.vector("up", {0, 1, 0}, any_range, ""), Vec3d(0, 1, 0));
  EXPECT_EQ(r.params.color("c", Vec3d(0.5), ""), Vec3d(0.5));
  EXPECT_EQ(r.params.choice("kind", 0, {"a", "b"}, ""), 0);
  EXPECT_EQ(r.messages(),
            "\"spread\" of fern \"tall\": expected a number in deg, found text\n"
            "\"wet\" of fern \"tall\": expected true or false, found a number\n"
            "\"label\" of fern \"tall\": expected text, found a number\n"
            "\"up\" of fern \"tall\": expected three numbers [x, y, z], found an array of 1\n"
            "\"c\" of fern \"tall\": expected a colour: [red, green, blue] or one number for grey, found text\n"
            "\"kind\" of fern \"tall\": expected one of \"a\", \"b\", found false\n");
}

TEST(Params, ReportsNumbersOutOfRange) {
  Reading r(object({{"a", number(200)},
                    {"b", number(-1)},
                    {"c", number(2)},
                    {"d", number(1.5)},
                    {"e", number(1e300)},
                    {"f", number(std::numeric_limits<double>::quiet_NaN())},
                    {"g", array({number(-1), number(0), number(-2)})}}));
  EXPECT_EQ(r.params.real("a", 40, angle, ""), 40);
  EXPECT_EQ(r.params.real("b", 1, {0, INFINITY, "m"}, ""), 1);
  EXPECT_EQ(r.params.real("c", 0, {-INFINITY, 1, ""}, ""), 0);
  EXPECT_EQ(r.params.integer("d", 3, any_range, ""), 3);
  EXPECT_EQ(r.params.integer("e", 3, any_range, ""), 3);
  EXPECT_EQ(r.params.real("f", 3, any_range, ""), 3);
  EXPECT_EQ(r.params.color("g", {1, 1, 1}, ""), Vec3d(1));
  EXPECT_EQ(r.messages(),
            "\"a\" of fern \"tall\" is 200; expected 0 to 180 deg\n"
            "\"b\" of fern \"tall\" is -1; expected at least 0 m\n"
            "\"c\" of fern \"tall\" is 2; expected at most 1\n"
            "\"d\" of fern \"tall\" is 1.5; expected a whole number\n"
            "\"e\" of fern \"tall\" is 1e+300; expected -2147483648 to 2147483647\n"
            "\"f\" of fern \"tall\" is nan; expected a finite number\n"
            "\"g\" of fern \"tall\" is -1; expected at least 0\n"
            "\"g\" of fern \"tall\" is -2; expected at least 0\n");
}

TEST(Params, AcceptsTheEndsOfARange) {
  Reading r(object({{"a", number(0)}, {"b", number(180)}}));
  EXPECT_EQ(r.params.real("a", 1, angle, ""), 0);
  EXPECT_EQ(r.params.real("b", 1, angle, ""), 180);
  EXPECT_EQ(r.messages(), "");
}

TEST(Params, SuggestsTheNearestChoice) {
  Reading r(object({{"scheme", text("catmul-clark")}, {"kind", text("zzz")}}));
  EXPECT_EQ(r.params.choice("scheme", 1, {"catmull-clark", "loop"}, ""), 1);
  r.params.choice("kind", 0, {"a", "b"}, "");
  EXPECT_EQ(r.messages(),
            "\"scheme\" of fern \"tall\" has no choice \"catmul-clark\"; did you mean \"catmull-clark\"?; known: "
            "catmull-clark, loop\n"
            "\"kind\" of fern \"tall\" has no choice \"zzz\"; known: a, b\n");
}

TEST(Params, ReportsWhatIsRequiredAndMissing) {
  Reading r(object({{"to", text("there")}}));
  EXPECT_EQ(r.params.required_real("height", {2, 5, "m"}, "of the stem"), 2);
  EXPECT_EQ(r.params.required_vector("to", ""), Vec3d());
  EXPECT_EQ(r.params.required_text("file", ""), "");
  EXPECT_EQ(r.params.raw("rules", true, "", "by symbol"), nullptr);
  EXPECT_EQ(r.messages(),
            "fern \"tall\" needs \"height\": of the stem\n"
            "\"to\" of fern \"tall\": expected three numbers [x, y, z], found text\n"
            "fern \"tall\" needs \"file\"\n"
            "fern \"tall\" needs \"rules\": by symbol\n");
}

TEST(Params, ReportsUnknownKeysWithTheNearest) {
  Reading r(object({{"sprad", number(1)}, {"zzz", number(1)}, {"fronds", number(1)}}));
  r.params.real("spread", 1, angle, "");
  r.params.integer("fronds", 1, any_range, "");
  r.params.finish();
  EXPECT_EQ(r.messages(),
            "fern \"tall\" has no \"sprad\"; did you mean \"spread\"?\n"
            "fern \"tall\" has no \"zzz\"; known: spread, fronds\n");
}

TEST(Params, ReportsOnceWhatIsNoObject) {
  Reading r(number(3));
  r.params.required_real("height", any_range, "");
  r.params.finish();
  EXPECT_EQ(r.messages(), "fern \"tall\": expected an object, found a number\n");
}

TEST(Params, PointsAtTheValue) {
  Value v = object({{"spread", text("wide")}});
  const auto source = std::make_shared<SourceText>(SourceText{"s", "{ \"spread\": \"wide\" }"});
  v.location = {source, 0};
  v.members[0].value.location = {source, 12};
  Reading r(v);
  r.params.real("spread", 1, angle, "");
  r.params.error("spread", "too wide for \"height\"");
  r.params.error("height", "too small");
  ASSERT_EQ(r.diagnostics.list().size(), 3u);
  EXPECT_EQ(r.diagnostics.list()[0].location.offset, 12u);
  EXPECT_EQ(r.diagnostics.list()[1].location.offset, 12u);
  EXPECT_EQ(r.diagnostics.list()[2].location.offset, 0u);  // not written: the object
}

TEST(Params, DescribesWhatItReads) {
  std::vector<ParamInfo> infos;
  Params params(infos);
  EXPECT_TRUE(params.describing());
  EXPECT_EQ(params.real("spread", 0.1, angle, "opening angle"), 0.1);
  EXPECT_EQ(params.choice("kind", 1, {"a", "b"}, ""), 1);
  EXPECT_EQ(params.required_real("height", {2, 5, "m"}, ""), 2);
  params.text("label", "say \"hi\"", "");
  params.color("c", Vec3d(0.5), "");
  params.vector("up", {0, 1, 0}, any_range, "");
  params.raw("rules", true, "{\"type\": \"object\"}", "");
  params.real("spread", 0.1, angle, "opening angle");  // twice, as in a loop
  ASSERT_EQ(infos.size(), 7u);
  EXPECT_EQ(infos[0].name, "spread");
  EXPECT_EQ(infos[0].default_text, "0.1");
  EXPECT_EQ(infos[0].doc, "opening angle");
  EXPECT_EQ(infos[0].range.max, 180);
  EXPECT_EQ(infos[1].default_text, "\"b\"");
  EXPECT_EQ(infos[1].choices, (std::vector<std::string>{"a", "b"}));
  EXPECT_TRUE(infos[2].required);
  EXPECT_EQ(infos[3].default_text, "\"say \\\"hi\\\"\"");
  EXPECT_EQ(infos[4].default_text, "0.5");
  EXPECT_EQ(infos[5].default_text, "[0, 1, 0]");
  EXPECT_EQ(infos[6].schema, "{\"type\": \"object\"}");
}

TEST(Params, DescribingToleratesAConstructorThatReports) {
  std::vector<ParamInfo> infos;
  Params params(infos);
  params.error("spread", "said to nobody");
  EXPECT_TRUE(params.diagnostics().has_errors());
  EXPECT_EQ(params.location().line(), 0);
  params.finish();
}

TEST(RangeText, NamesBothEndsOne) {
  EXPECT_EQ(range_text(angle), "0 to 180 deg");
  EXPECT_EQ(range_text(not_negative), "at least 0");
  EXPECT_EQ(range_text({-INFINITY, 2.5, "s"}), "at most 2.5 s");
  EXPECT_EQ(range_text(any_range), "");
}

}  // namespace
}  // namespace meristem
