// Foliage and spikes far away: as much of them, and as bright, as in the picture in full.
#include "renderer/loading/load_scene.h"
#include "renderer/report/statistics.h"
#include "renderer/session/session.h"
#include "tests/renderer/image/scratch_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <regex>

namespace meristem {
namespace {

// One plant of a shipped scene, lit from the front in an empty space; the camera stands so far away.
class Thinning : public testing::TestWithParam<std::tuple<const char*, double, double>> {
 protected:
  double luminance(double detail, bool thins) const {
    const auto& [name, distance, tolerance] = GetParam();
    std::string text = read_text(std::string(MERISTEM_SOURCE_DIR "/scenes/") + name + "/" + name + ".jsonc");
    EXPECT_NE(text.find("\"thinning\""), std::string::npos);
    if (!thins) text = std::regex_replace(text, std::regex(R"("thinning": \{[^}]*\},)"), "");
    const std::string path = folder_ / "scene.jsonc";
    std::ofstream(path) << text;
    LoadOptions options;
    options.set = {std::string(R"(/objects=[{"model":")") + name + R"("}])",
                   R"(/lights=[{"type":"distant","direction":[-0.3,-0.5,-1]}])",
                   R"(/camera={"from":[0,0.6,)" + std::to_string(distance) + R"(],"to":[0,0.6,0],"fov":30})"};
    options.samples = 32;
    options.width = 48;
    options.height = 27;
    options.max_depth = 2;
    options.detail = detail;
    const LoadedScene loaded = load_scene(path, options);
    RenderSession session(*loaded.scene, {.threads = 2});
    session.render();
    EXPECT_TRUE(loaded.scene->intersector->statistics().defects.empty());
    const Image image = session.film().develop();
    double sum = 0;
    for (std::size_t i = 0; i < image.pixels.size(); i += std::size_t(image.channels))
      sum += 0.2126 * double(image.pixels[i]) + 0.7152 * double(image.pixels[i + 1]) +
             0.0722 * double(image.pixels[i + 2]);
    return sum;
  }
  const ScratchFolder folder_;
};

// Some ten pixels high. Cover stays within a few per cent; what stands for others hides and shades less of itself.
TEST_P(Thinning, ASmallPlantIsAboutAsBrightAsTheOneInFull) {
  const double full = luminance(0.2, true);
  const double thinned = luminance(1, true) / full - 1, left_out = luminance(1, false) / full - 1;
  RecordProperty("thinned", std::to_string(thinned));
  RecordProperty("left_out", std::to_string(left_out));
  EXPECT_LT(left_out, -0.25);
  EXPECT_LT(std::abs(thinned), std::get<2>(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Plants, Thinning,
                         testing::Values(std::tuple("bush", 8.0, 0.2), std::tuple("cactus", 24.0, 0.1)));

}  // namespace
}  // namespace meristem
