// `meristem` from its arguments to its files, with scene files that are right and scene files that are hostile.
#include "renderer/cli/command_line.h"
#include "geometry/base/process_memory.h"
#include "renderer/image/image.h"
#include "renderer/language/jsonc_reader.h"
#include "tests/renderer/image/scratch_folder.h"
#include "tests/renderer/loading/branch_scene.h"

#include <gtest/gtest.h>

#include <fstream>

namespace meristem {
namespace {

class WholeProgram : public testing::Test {
 protected:
  // Runs `meristem` in the scratch folder, with `scene` as the file a.jsonc. Fills out_ and error_.
  int run(const std::string& scene, std::vector<std::string> arguments) {
    std::ofstream(folder_ / "a.jsonc") << scene;
    arguments.insert(arguments.begin(), "meristem");
    std::vector<const char*> argv;
    for (const std::string& a : arguments) argv.push_back(a.c_str());
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(folder_ / "");
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = run_command_line(int(argv.size()), argv.data());
    out_ = testing::internal::GetCapturedStdout();
    error_ = testing::internal::GetCapturedStderr();
    std::filesystem::current_path(before);
    return code;
  }

  // The scene is refused with these words, and nothing is written.
  void expect_refused(const std::string& scene, const std::vector<std::string>& words) {
    EXPECT_EQ(run(scene, {"render", "a.jsonc", "--size", "8x8", "--samples", "1"}), 2) << scene;
    for (const std::string& part : words) EXPECT_NE(error_.find(part), std::string::npos) << part << "\nin\n" << error_;
    EXPECT_EQ(folder_.files(), 1u);
  }

  Value statistics() const {
    Diagnostics diagnostics;
    return read_jsonc(std::make_shared<SourceText>(SourceText{"s", read_text(folder_ / "s.json")}), diagnostics);
  }

  ScratchFolder folder_;
  std::string out_, error_;
};

// A scene around one model.
std::string scene_with(const std::string& model) {
  return R"({ "models": { "m": )" + model + R"( }, "objects": [ { "model": "m" } ], "camera": { "from": [0, 2, 9] } })";
}
std::string scene_with_rules(const std::string& levels, const std::string& rules) {
  return scene_with(R"j({ "base": { "type": "prism", "cap": "a(1)" }, "steps": [ { "grow": )j" + levels +
                    R"(, "rules": { )" + rules + R"( } } ] })");
}

TEST_F(WholeProgram, RendersToImagesAndFigures) {
  ASSERT_EQ(
      run(branch_scene(), {"render", "a.jsonc", "-o", "a.exr", "-o", "a.png", "--stats", "s.json", "--threads", "2"}),
      0)
      << error_;
  EXPECT_EQ(folder_.files(), 4u);
  for (const char* file : {"a.exr", "a.png"}) {
    const Image image = read_image(folder_ / file);
    EXPECT_EQ(image.width, 64);
    EXPECT_EQ(image.height, 36);
  }
  const Value s = statistics();
  for (const char* figure : {"wall_s", "first_pixel_s", "load_s", "render_s", "peak_rss_bytes", "rays_per_s"}) {
    ASSERT_TRUE(s.find(figure)) << figure;
    EXPECT_GT(s.find(figure)->number, 0) << figure;
  }
  const Value& rays = *s.find("rays");
  EXPECT_EQ(rays.find("camera")->number, 64 * 36);
  EXPECT_GT(rays.find("bounce")->number, 0);
  EXPECT_GT(rays.find("shadow")->number, 0);
  EXPECT_EQ(s.find("image")->find("nonfinite")->number, 0);
  EXPECT_EQ(s.find("image")->find("sha256")->text.size(), 64u);
}

TEST_F(WholeProgram, FiguresSayWhatExpansionDid) {
  ASSERT_EQ(run(branch_scene(), {"render", "a.jsonc", "-o", "a.exr", "--stats", "s.json", "-q", "--detail", "0"}), 0)
      << error_;
  EXPECT_EQ(error_, "");
  const Value s = statistics();
  const Value& expansion = *s.find("expansion");
  for (const char* figure : {"cells_expanded", "faces", "time_s", "resident_bytes_peak"})
    EXPECT_GT(expansion.find(figure)->number, 0) << figure;
  for (const char* figure :
       {"reexpanded", "evicted", "failed", "invalid_rays", "limbo_bytes_peak"})  // the budget is large
    EXPECT_EQ(expansion.find(figure)->number, 0) << figure;
  EXPECT_GE(expansion.find("waits")->number, 0);
  EXPECT_TRUE(expansion.find("defects")->items.empty());
  const std::vector<Value>& steps = expansion.find("by_step")->items;
  ASSERT_EQ(steps.size(), 9u);
  EXPECT_EQ(steps.front().find("step")->text, "grow 1");
  EXPECT_EQ(steps.back().find("step")->text, "subdivide 4 (placed)");
}

TEST_F(WholeProgram, ChecksWithoutRendering) {
  EXPECT_EQ(run(branch_scene(), {"check", "a.jsonc"}), 0) << error_;
  EXPECT_NE(out_.find("no errors, 0 warnings"), std::string::npos) << out_;
  EXPECT_EQ(folder_.files(), 1u);
}

TEST_F(WholeProgram, RefusesImagesThatNoMemoryHolds) {
  if (machine_memory_bytes() == 0 || machine_memory_bytes() >> 38) GTEST_SKIP() << "this machine may hold it";
  EXPECT_EQ(run(branch_scene(), {"render", "a.jsonc", "--size", "65536x65536", "-o", "a.exr"}), 2);
  EXPECT_NE(error_.find("takes at least 256 GiB"), std::string::npos) << error_;
  EXPECT_NE(error_.find("--crop"), std::string::npos) << error_;
}

TEST_F(WholeProgram, ForetellsHowManyFacesModelsHave) {
  const std::string scene = R"json({ "format": 1, "models": {
    "cube": { "base": { "type": "box" }, "steps": [ { "subdivide": 2 } ] },
    "endless": { "base": { "type": "prism", "cap": "a" }, "steps": [
      { "grow": 60, "rules": { "a": { "template": "fork", "faces": { "left": "a", "right": "a" } } } } ] },
    "aspen": { "base": { "type": "weber_penn", "species": "quaking_aspen" } },
    "unused": { "base": { "type": "box" } } },
    "objects": [ { "model": "cube" }, { "model": "cube", "seed": 1 }, { "model": "endless" }, { "model": "aspen" } ],
    "camera": { "from": [0, 0, 9] } })json";
  EXPECT_EQ(run(scene, {"check", "a.jsonc"}), 0) << error_;
  EXPECT_NE(out_.find("model      cube: 96 faces in full, estimated\n"), std::string::npos) << out_;
  EXPECT_NE(out_.find("model      endless: 2e+19 faces in full, estimated\n"), std::string::npos) << out_;
  EXPECT_EQ(out_.find("unused:"), std::string::npos) << out_;
  // It has 69,800, and about as many with other seeds
  const std::size_t aspen = out_.find("model      aspen: ");
  ASSERT_NE(aspen, std::string::npos) << out_;
  EXPECT_NEAR(std::stod(out_.substr(aspen + 18)), 69800, 35000) << out_;
}

TEST_F(WholeProgram, DescribesEveryKindByItsName) {
  for (const char* kind : {"section", "base", "step", "production", "template", "material", "light", "camera",
                           "integrator", "sampler", "filter"})
    EXPECT_EQ(run("", {"describe", kind}), 0) << error_;
}

TEST_F(WholeProgram, RefusesAFileThatIsNotThere) {
  EXPECT_NE(run("", {"render", "b.jsonc"}), 0);
  EXPECT_NE(error_.find("b.jsonc"), std::string::npos) << error_;
}

TEST_F(WholeProgram, RefusesTextThatIsNoScene) {
  expect_refused("", {"a.jsonc:1:1: error: "});
  expect_refused("[]", {"a.jsonc:1:1: error: "});
  expect_refused("{", {"a.jsonc:1:"});
  expect_refused(R"({ "camra": {} })", {"camra", "did you mean \"camera\"?"});
  expect_refused("{}", {"the scene has no \"camera\""});
  expect_refused(R"({ "camera": {}, "objects": {} })", {"\"objects\" is an array"});
}

TEST_F(WholeProgram, RefusesUnknownNames) {
  expect_refused(
      R"({ "models": { "oak": { "base": { "type": "box" } } }, "objects": [ { "model": "oat" } ], "camera": {} })",
      {"no model named \"oat\"; did you mean \"oak\"?; known: oak"});
  expect_refused(R"({ "objects": [ { "model": "oak" } ], "camera": {} })", {"no model named \"oak\""});
  expect_refused(R"({ "materials": { "bark": {} }, "camera": {},
    "models": { "oak": { "base": { "type": "box" }, "material": "bork" } }, "objects": [ { "model": "oak" } ] })",
                 {"no material named \"bork\"; did you mean \"bark\"?; known: bark"});
  expect_refused(scene_with(R"({ "base": { "type": "bocks" } })"), {"no base named \"bocks\"", "box"});
  expect_refused(scene_with_rules("1", R"j("a(x)": [ { "template": "segmnt" } ])j"),
                 {"no template named \"segmnt\"; did you mean \"segment\"?"});
}

TEST_F(WholeProgram, RefusesMissingSections) {
  expect_refused(scene_with("{}"), {"\"base\""});
  expect_refused(scene_with(R"({ "base": {} })"), {"a base needs a \"type\""});
  expect_refused(scene_with(R"({ "base": { "type": "box" }, "steps": [ {} ] })"),
                 {"a step is an object with \"subdivide\" or \"grow\""});
  expect_refused(R"({ "objects": [ {} ], "camera": {} })", {"\"model\""});
}

TEST_F(WholeProgram, TheOnlyCameraHasNoName) {
  EXPECT_EQ(run(scene_with("{ \"base\": { \"type\": \"box\" } }"), {"render", "a.jsonc", "--camera", "side"}), 2);
  EXPECT_NE(error_.find("no camera named \"side\": the scene's only one has no name"), std::string::npos) << error_;
  EXPECT_EQ(run(R"({ "cameras": { "a": {}, "b": {} } })", {"render", "a.jsonc", "--camera", "side"}), 2);
  EXPECT_NE(error_.find("no camera named \"side\"; known: a, b"), std::string::npos) << error_;
}

TEST_F(WholeProgram, ABudgetThatIsTooSmallIsToldInItsOwnUnit) {
  EXPECT_EQ(run(branch_scene(), {"render", "a.jsonc", "--budget", "2K"}), 2);
  EXPECT_NE(error_.find("the budget of 2 KiB is too small"), std::string::npos) << error_;
}

TEST_F(WholeProgram, AMeshThatCannotBeReadIsOneError) {
  std::ofstream(folder_ / "b.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n";
  EXPECT_EQ(run(scene_with(R"({ "base": { "type": "mesh", "file": "b.obj" } })"), {"check", "a.jsonc"}), 2);
  EXPECT_NE(error_.find("there is no vertex 9"), std::string::npos) << error_;
  EXPECT_EQ(error_.find("has no faces"), std::string::npos) << error_;
}

TEST_F(WholeProgram, RefusesWrongRayClassDetail) {
  const auto with = [](const std::string& detail) {
    return R"({ "camera": {}, "render": { "ray_class_detail": )" + detail + " } }";
  };
  expect_refused(with("4"), {"a.jsonc:1:", "\"ray_class_detail\" is an object such as"});
  expect_refused(with(R"({ "difuse": 4 })"), {"difuse", "did you mean \"diffuse\"?"});
  expect_refused(with(R"({ "shadow": 0 })"), {"shadow", "0.01"});
}

TEST_F(WholeProgram, RefusesMoreThan64Levels) {
  const auto subdivide = [](int times) {
    std::string steps;
    for (int i = 0; i < times; ++i) steps += R"({ "subdivide": 1 },)";
    return scene_with(R"({ "base": { "type": "box" }, "steps": [ )" + steps + " ] }");
  };
  expect_refused(subdivide(65), {"the steps make 65 levels; the limit is 64"});
}

TEST_F(WholeProgram, RulesWithoutEndStopAtTheirLevels) {
  // A level replaces each face once, and a model has 64 levels at most
  const std::string endless = R"j("a(x)": [ { "template": "segment", "length": "x", "faces": { "cap": "a(x)" } } ])j";
  EXPECT_EQ(run(scene_with_rules("60", endless), {"render", "a.jsonc", "--size", "8x8", "--samples", "1"}), 0)
      << error_;
  std::filesystem::remove(folder_ / "a.exr");
  std::filesystem::remove(folder_ / "a.png");
  expect_refused(scene_with_rules("1000000", endless), {"a.jsonc:1:"});
}

TEST_F(WholeProgram, RefusesHugeNumbers) {
  expect_refused(scene_with(R"({ "base": { "type": "prism", "sides": 1e9 } })"), {"\"sides\""});
  expect_refused(scene_with(R"({ "base": { "type": "box" }, "steps": [ { "subdivide": 1e300 } ] })"),
                 {"\"subdivide\""});
  expect_refused(R"({ "camera": {}, "render": { "size": [1e9, 1e9] } })", {"\"size\" is [width, height]"});
  expect_refused(R"({ "camera": {}, "render": { "samples": 1e12 } })", {"\"samples\""});
}

TEST_F(WholeProgram, HugeParametersKeepToTheirRanges) {
  const std::string exploding =
      R"j("a(x)": [ { "template": "segment", "length": "x*1e30", "faces": { "cap": "a(x*1e30)" } } ])j";
  EXPECT_EQ(run(scene_with_rules("60", exploding), {"check", "a.jsonc"}), 0) << error_;
}

}  // namespace
}  // namespace meristem
