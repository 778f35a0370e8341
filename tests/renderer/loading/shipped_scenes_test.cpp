// The scenes of the figures: lazy and eager expansion give the same bits, and nothing leaves its bounds. Each is made
// small first: fewer levels, fewer pixels, the same rules.
#include "renderer/loading/load_scene.h"
#include "renderer/report/statistics.h"
#include "renderer/session/session.h"
#include "tests/renderer/image/scratch_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <regex>

namespace meristem {
namespace {

// `"subdivide": 4` becomes `"subdivide": 1`, and no rule is applied more than 7 times.
std::string made_small(std::string text) {
  text = std::regex_replace(text, std::regex(R"("subdivide": \d+)"), R"("subdivide": 1)");
  text = std::regex_replace(text, std::regex(R"("grow": ([89]|\d\d))"), R"("grow": 7)");
  return std::regex_replace(text, std::regex(R"("counts": \[\d+)"), R"("counts": [1)");
}

class ShippedScenes : public testing::TestWithParam<const char*> {};

TEST_P(ShippedScenes, LazyAndEagerAreTheSameBits) {
  const std::string name = GetParam();
  const ScratchFolder folder;
  const std::string path = folder / "scene.jsonc";
  std::ofstream(path) << made_small(
      read_text(std::string(MERISTEM_SOURCE_DIR "/scenes/") + name + "/" + name + ".jsonc"));
  const auto render = [&](ExpandMode mode) {
    LoadOptions options;
    options.expand = mode;
    options.samples = 1;
    options.width = 48;
    options.height = 27;
    options.max_depth = 2;
    const LoadedScene loaded = load_scene(path, options);
    RenderSession session(*loaded.scene, {.threads = 2});
    session.render();
    EXPECT_TRUE(loaded.scene->intersector->statistics().defects.empty());
    return image_sha256(session.film().develop());
  };
  EXPECT_EQ(render(ExpandMode::Lazy), render(ExpandMode::Eager));
}

INSTANTIATE_TEST_SUITE_P(Figures, ShippedScenes,
                         testing::Values("branch", "bush", "cactus", "candle-holder", "chair", "ivy", "mesh-growing",
                                         "mist", "samara", "subdivision", "tree-branch"),
                         [](const auto& scene) {
                           std::string name = scene.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace meristem
