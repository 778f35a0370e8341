#include "renderer/language/override.h"

#include "renderer/language/jsonc_reader.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

class OverrideTest : public testing::Test {
 protected:
  OverrideTest() {
    const char* text =
        R"({ "camera": { "fov": 30 }, "lights": [ { "type": "sky" }, { "type": "sphere" } ], "a/b": 1 })";
    scene_ = read_jsonc(std::make_shared<SourceText>(SourceText{"a.jsonc", text}), diagnostics_);
  }
  void set(const std::string& text, int frame = 0) { apply_override(scene_, text, frame, diagnostics_); }
  std::string first_message() const { return diagnostics_.list().empty() ? "" : diagnostics_.list()[0].formatted(); }

  Diagnostics diagnostics_;
  Value scene_;
};

TEST_F(OverrideTest, ReplacesAndAddsValues) {
  set("/camera/fov=35.5");
  set("/camera/from=[1, 2, 3]");
  set("/lights/1/color={\"r\": true}");
  set("/render/integrator/type=normals");
  set("/materials/m/base_color=mix([1,0,0], P, .5)");
  set("/a~1b=\"x\"");
  EXPECT_EQ(first_message(), "");
  EXPECT_EQ(scene_.find("camera")->find("fov")->number, 35.5);
  EXPECT_EQ(scene_.find("camera")->find("from")->items[2].number, 3);
  EXPECT_TRUE(scene_.find("lights")->items[1].find("color")->find("r")->boolean);
  EXPECT_EQ(scene_.find("render")->find("integrator")->find("type")->text, "normals");
  EXPECT_EQ(scene_.find("materials")->find("m")->find("base_color")->text, "mix([1,0,0], P, .5)");
  EXPECT_EQ(scene_.find("a/b")->text, "x");
}

TEST_F(OverrideTest, FormulasOfTheFrame) {
  set("/camera/fov==30 + 2*frame", 7);
  set("/camera/from==[frame, 1, 0.5]", 3);
  EXPECT_EQ(first_message(), "");
  EXPECT_EQ(scene_.find("camera")->find("fov")->number, 44);
  ASSERT_EQ(scene_.find("camera")->find("from")->items.size(), 3u);
  EXPECT_EQ(scene_.find("camera")->find("from")->items[0].number, 3);
}

TEST_F(OverrideTest, MistakesAreShownInTheOption) {
  const std::pair<const char*, const char*> wrong[] = {
      {"camera/fov=3", "--set:1:1: error: expected /path=value"},
      {"/camera/fov", "--set:1:1: error: expected /path=value"},
      {"/lights/2/color=1", "--set:1:9: error: no entry 2: the list has the entries 0 to 1"},
      {"/lights/x=1", "--set:1:9: error: no entry x"},
      {"/camera/fov/x=1", "--set:1:13: error: \"x\" lies in a number"},
      {"/camera/from=[1, 2", "--set:1:"},
      {"/camera/fov==30 + fram", "--set:1:19: error:"},
  };
  for (const auto& [text, message] : wrong) {
    Diagnostics mistakes;
    Value scene = scene_;
    apply_override(scene, text, 0, mistakes);
    ASSERT_FALSE(mistakes.list().empty()) << text;
    const std::string said = mistakes.list()[0].formatted();
    EXPECT_NE(said.find(message), std::string::npos) << said;
  }
}

TEST_F(OverrideTest, ValuesKnowTheirPlaceInTheOption) {
  set("/camera/from=[1, \"two\", 3]");
  const Location place = scene_.find("camera")->find("from")->items[1].location;
  EXPECT_EQ(place.source->name, "--set");
  EXPECT_EQ(place.column(), 18);
}

}  // namespace
}  // namespace meristem
