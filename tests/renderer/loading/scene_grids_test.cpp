// The section "grids" of a scene: a level set of a model to grow along, and mistakes in naming grids.
#include "geometry/cells/shown_surfaces.h"
#include "renderer/loading/load_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <unistd.h>

namespace meristem {
namespace {

struct SceneGridsTest : testing::Test {
  SceneGridsTest()
      : path(std::filesystem::temp_directory_path() / ("grids_" + std::to_string(::getpid()) + ".jsonc")) {}
  ~SceneGridsTest() override { std::filesystem::remove(path); }
  LoadedScene load(const std::string& sections) {
    std::ofstream(path) << "{ " << sections << R"(, "camera": { "from": [0, 1, 3], "to": [0, 0, 0] } })";
    LoadOptions options;
    options.check_only = options.keep_objects = true;
    return load_scene(path.string(), options);
  }
  std::string error(const std::string& sections) {
    try {
      load(sections);
    } catch (const SceneErrors& e) {
      return e.list().front().message;
    }
    return "";
  }
  std::filesystem::path path;
};

constexpr const char* tendril = R"json(
  "grids": { "ball": { "model": "ball", "spacing": 0.04, "band": 0.3 } },
  "models": {
    "ball": { "base": { "type": "sphere", "radius": 0.5, "divisions": 16 } },
    "tendril": { "base": { "type": "mesh",
        "vertices": [[0.54, -0.3, 0.01], [0.56, -0.3, 0.01], [0.56, -0.3, -0.01], [0.54, -0.3, -0.01]],
        "polygons": [[0, 1, 2, 3]], "names": ["tip"], "symbols": { "tip": "tip" } },
      "steps": [ { "grow": 30, "rules": { "tip": { "template": "segment", "length": 0.03, "tropism": 1.2,
        "toward": "g = norm(vdb_gradient('ball', P)); [0, 1, 0] - g*g[1] + g*clamp(20*(.03 - vdb('ball', P)), -1, 1)",
        "faces": { "cap": "tip" } } } } ] } },
  "objects": [ { "model": "tendril" } ])json";

TEST_F(SceneGridsTest, ATendrilGrowsAlongAnotherModel) {
  const LoadedScene loaded = load(tendril);
  double highest = -1;
  std::size_t near_the_ball = 0, all = 0;
  for (const ShownSurface& s : shown_surfaces(loaded.objects, nullptr, 10))
    for_each_tessellation(s, [&](const Tessellation& t, double) {
      for (const Vec3f& p : t.positions) {
        highest = std::max(highest, double(p.y));
        near_the_ball += std::abs(double(length(p)) - 0.53) < 0.06;
        ++all;
      }
    });
  EXPECT_GT(highest, 0.4);  // without the ball it would stand upright, at x = 0.55
  ASSERT_GT(all, 100u);
  EXPECT_GT(double(near_the_ball), 0.85 * double(all));
}

TEST_F(SceneGridsTest, MistakesAreNamed) {
  const auto material = [](const std::string& expression) {
    return R"("grids": { "rock": { "value": "P[0]", "from": [0, 0, 0], "to": [1, 1, 1], "spacing": 0.5 } },
      "materials": { "a": { "base_color": ")" +
           expression + R"(" } })";
  };
  EXPECT_EQ(error(material("vdb('rock', P)")), "");
  EXPECT_EQ(
      error(material("vdb('rok', P)")),
      "no grid named \"rok\"; did you mean \"rock\"?; it names one of the scene's \"grids\" (rock) or a file that "
      "ends in .vdb");
  EXPECT_EQ(error(material("vdb('none.vdb', P)")), "none.vdb: there is no such file");
  EXPECT_EQ(error(material("vdb('../none.vdb', P)")),
            "../none.vdb: a file must lie in the folder of its scene file or below it");
  EXPECT_EQ(error(material("vdb('/etc/none.vdb', P)")),
            "/etc/none.vdb: a file must lie in the folder of its scene file or below it");
  EXPECT_EQ(error(R"("grids": { "a": { "spacing": 1 } })"), "a: a grid has a \"file\", a \"model\" or a \"value\"");
  EXPECT_NE(error(R"json("grids": { "g": { "model": "m", "spacing": 0.1 } },
    "models": { "m": { "base": { "type": "sphere" },
      "steps": [ { "subdivide": 1, "place": "N*vdb('g', P)" } ] } })json"),
            "");
}

}  // namespace
}  // namespace meristem
