// Textures seen from near and far, in mirrors and behind glass: filtered by the footprint of the path.
#include "renderer/image/image.h"
#include "renderer/loading/load_scene.h"
#include "renderer/report/statistics.h"
#include "renderer/session/session.h"
#include "tests/renderer/image/scratch_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numeric>

namespace meristem {
namespace {

class TextureFilter : public testing::Test {
 protected:
  // 32 x 32 texels: squares of 4, black and white.
  TextureFilter() {
    Image checker{32, 32, 3, {}};
    for (int i = 0; i < 32 * 32; ++i) checker.pixels.insert(checker.pixels.end(), 3, float((i / 4 + i / 128) % 2));
    write_image(folder_ / "checker.png", checker);
  }

  // A plane to the horizon that glows by the checker, 16 squares of it a metre, and `more` objects on it.
  std::string scene(double filter, int samples, const std::string& more = "", int max_depth = 0) const {
    return fmt::format(R"json({{ "format": 1, "models": {{
        "plane": {{ "base": {{ "type": "plane", "width": 4000, "depth": 4000 }}, "material": "checks" }},
        "ball": {{ "base": {{ "type": "sphere", "radius": 0.5 }}, "steps": [ {{ "subdivide": 3 }} ],
                   "material": "glass" }},
        "wall": {{ "base": {{ "type": "box", "size": [3, 2, 0.1] }}, "material": "mirror" }} }},
      "materials": {{
        "checks": {{ "base_color": 0, "specular_weight": 0, "emission_luminance": 1, "emission_color": "t",
          "textures": {{ "t": {{ "file": "checker.png", "u": "2*P[0]", "v": "8000*v", "filter": {} }} }} }},
        "glass": {{ "transmission_weight": 1, "specular_roughness": 0 }},
        "mirror": {{ "base_metalness": 1, "base_color": 0.9, "specular_roughness": 0.1 }} }},
      "objects": [ {{ "model": "plane" }} {} ],
      "camera": {{ "from": [0, 1.5, 0], "to": [0.3, 1.2, -3], "fov": 40 }},
      "render": {{ "size": [48, 27], "samples": {}, "max_depth": {} }} }})json",
                       filter, more, samples, max_depth);
  }

  LoadedScene load(const std::string& text, RayOrder order = RayOrder::DepthFirst) const {
    std::ofstream(path_) << text;
    LoadOptions options;
    options.ray_order = order;
    return load_scene(path_, options);
  }
  Image render(const std::string& text, RayOrder order = RayOrder::DepthFirst, int threads = 2) const {
    const LoadedScene loaded = load(text, order);
    RenderSession session(*loaded.scene, {.threads = threads});
    session.render();
    return session.film().develop();
  }

  static double mean(const Image& image) {
    return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0) / double(image.pixels.size());
  }
  static double error(const Image& a, const Image& b) {
    double squares = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) squares += std::pow(double(a.pixels[i] - b.pixels[i]), 2);
    return std::sqrt(squares / double(a.pixels.size()));
  }

  ScratchFolder folder_;
  const std::string path_ = folder_ / "scene.jsonc";
};

constexpr const char* ball_and_wall =
    R"json(, { "model": "ball", "position": [0.5, 0.5, -3] }, { "model": "wall", "position": [-0.5, 0, -5] })json";

TEST_F(TextureFilter, FineChecksToTheHorizonAreNearerTheirMean) {
  const Image reference = render(scene(0, 1024));
  const Image point = render(scene(0, 1)), filtered = render(scene(0.5, 1)), wide = render(scene(1, 1));
  EXPECT_LT(error(filtered, reference), 0.4 * error(point, reference));
  EXPECT_LT(error(wide, reference), error(filtered, reference));
  EXPECT_NEAR(mean(filtered), mean(reference), 0.01 * mean(reference));
  const Image many_filtered = render(scene(0.5, 64));
  EXPECT_LT(error(many_filtered, reference), error(render(scene(0, 64)), reference));
  EXPECT_NEAR(mean(many_filtered), mean(reference), 0.004 * mean(reference));
}

TEST_F(TextureFilter, GoesThroughGlassAndMirrors) {
  const Image reference = render(scene(0, 256, ball_and_wall, 4)), point = render(scene(0, 4, ball_and_wall, 4)),
              filtered = render(scene(0.5, 4, ball_and_wall, 4));
  EXPECT_LT(error(filtered, reference), 0.6 * error(point, reference));
  EXPECT_NEAR(mean(filtered), mean(reference), 0.01 * mean(reference));
}

TEST_F(TextureFilter, HasTheSameBitsForAnyThreadsAndOrder) {
  const std::string text = scene(0.5, 2, ball_and_wall, 4);
  const std::string expected = image_sha256(render(text));
  EXPECT_NE(expected, image_sha256(render(scene(0, 2, ball_and_wall, 4))));
  for (const int threads : {1, 8})
    for (const RayOrder order : {RayOrder::DepthFirst, RayOrder::Queued})
      EXPECT_EQ(image_sha256(render(text, order, threads)), expected) << threads << " threads, order " << int(order);
}

}  // namespace
}  // namespace meristem
