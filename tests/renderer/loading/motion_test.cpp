// Scenes in which something moves while the shutter is open: their pictures against what can be computed, and against
// each other.
#include "renderer/loading/load_scene.h"
#include "renderer/session/session.h"
#include "tests/renderer/image/scratch_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>

namespace meristem {
namespace {

constexpr int width = 48, height = 24;
constexpr double pixels_a_metre = 10;  // in the plane z = 0

// Where in that plane the middle of the image is (0, 0), y up.
struct Place {
  double x, y;
};

class MotionScene : public testing::Test {
 protected:
  // Seen from (0, 0, 10). `models` beside "sheet", a square metre in the plane z = 0; the shutter is open for all of
  // the frame.
  static std::string scene(const std::string& objects, const std::string& models = "", const std::string& render = "",
                           const std::string& camera = R"("from": [0, 0, 10], "to": [0, 0, 0])") {
    const double fov = 2 * std::atan(height / pixels_a_metre / 2 / 10) * 180 / pi;
    return fmt::format(R"json({{ "models": {{ "board": {{ "base": {{ "type": "box", "size": [1, 1, 1e-4] }} }},
        "sheet": {{ "group": [ {{ "model": "board", "position": [0, -0.5, 0] }} ] }}{} }},
      "objects": [ {} ], "camera": {{ "fov": {}, {} }},
      "render": {{ "size": [{}, {}], "samples": 256, "shutter": 1, "integrator": {{ "type": "normals" }},
                   "filter": {{ "type": "box" }}{} }} }})json",
                       models, objects, fov, camera, width, height, render);
  }

  static std::string with_shutter(std::string text, const char* shutter) {
    const std::string written = "\"shutter\": 1";
    return text.replace(text.find(written), written.size(), std::string("\"shutter\": ") + shutter);
  }

  LoadedScene load(const std::string& text, LoadOptions options = {}) {
    const std::string path = folder_ / "scene.jsonc";
    std::ofstream(path) << text;
    options.threads = 2;
    return load_scene(path, options);
  }
  Film film(const std::string& text, const LoadOptions& options = {}) {
    const LoadedScene loaded = load(text, options);
    RenderSession session(*loaded.scene, {.threads = 2});
    session.render();
    EXPECT_TRUE(loaded.scene->intersector->statistics().defects.empty());
    return session.film();
  }
  // By pixel, row by row.
  std::vector<float> coverage(const std::string& text, const LoadOptions& options = {}) {
    const Image image = film(text, options).develop();
    std::vector<float> result;
    for (std::size_t i = 3; i < image.pixels.size(); i += 4) result.push_back(image.pixels[i]);
    return result;
  }
  std::string error(const std::string& text) {
    try {
      load(text);
    } catch (const SceneErrors& errors) {
      return errors.list()[0].message;
    }
    return "";
  }

  // The coverage of what is inside at a time from 0 to 1, by many regular samples.
  static std::vector<float> integral(const std::function<bool(Place, double)>& inside) {
    constexpr int side = 8, times = 128;
    std::vector<float> result;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        int count = 0;
        for (int i = 0; i < side * side; ++i)
          for (int t = 0; t < times; ++t)
            count += inside({(x + (i % side + 0.5) / side - width / 2.) / pixels_a_metre,
                             (height / 2. - y - (i / side + 0.5) / side) / pixels_a_metre},
                            (t + 0.5) / times);
        result.push_back(float(count) / (side * side * times));
      }
    return result;
  }

  static void expect_near(const std::vector<float>& found, const std::vector<float>& expected, double most,
                          double mean) {
    ASSERT_EQ(found.size(), expected.size());
    double sum = 0, largest = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const double difference = double(std::abs(found[i] - expected[i]));
      sum += difference, largest = std::max(largest, difference);
    }
    EXPECT_LT(largest, most);
    EXPECT_LT(sum / double(found.size()), mean);
  }

  ScratchFolder folder_;
};

TEST_F(MotionScene, ABoxThatMovesCoversWhatItPassesForAsLongAsItPasses) {
  const auto expected =
      integral([](Place p, double t) { return std::abs(p.x - (2 * t - 1)) < 0.5 && std::abs(p.y - 0.3 * t) < 0.5; });
  expect_near(coverage(scene(R"({ "model": "sheet", "position": "[2*time - 1, 0.3*time, 0]" })")), expected, 0.05,
              0.005);
}

TEST_F(MotionScene, ABarThatTurnsCoversByTheAngle) {
  const auto expected = integral([](Place p, double t) {
    const double a = t * pi / 2, x = p.x * std::cos(a) + p.y * std::sin(a), y = p.y * std::cos(a) - p.x * std::sin(a);
    return std::abs(x) < 1 && std::abs(y) < 0.1;
  });
  expect_near(coverage(scene(R"({ "model": "sheet", "rotate": [0, 0, "90*time"], "scale": [2, 0.2, 1] })")), expected,
              0.06, 0.005);
}

TEST_F(MotionScene, ASizeThatChanges) {
  const auto expected =
      integral([](Place p, double t) { return std::max(std::abs(p.x), std::abs(p.y)) < 0.25 + t / 2; });
  expect_near(coverage(scene(R"({ "model": "sheet", "scale": "0.5 + time" })")), expected, 0.05, 0.005);
  expect_near(coverage(scene(R"({ "model": "sheet",
    "matrix": ["0.5 + time", 0, 0, 0,  0, "0.5 + time", 0, 0,  0, 0, 1, 0] })")),
              expected, 0.05, 0.005);
}

TEST_F(MotionScene, AGroupMayMoveWithin) {
  const std::string pair =
      R"(, "pair": { "group": [ { "model": "sheet", "scale": 0.5, "position": "[2*time - 1, 0.3, 0]" },
    { "model": "sheet", "scale": 0.5, "position": [0, -0.4, 0] } ] })";
  const auto expected = integral([](Place p, double t) {
    const double x = p.x, y = p.y - 0.4 * t;
    return (std::abs(x - (2 * t - 1)) < 0.25 && std::abs(y - 0.3) < 0.25) ||
           (std::abs(x) < 0.25 && std::abs(y + 0.4) < 0.25);
  });
  expect_near(coverage(scene(R"({ "model": "pair", "position": "[0, 0.4*time, 0]" })", pair)), expected, 0.05, 0.005);
}

TEST_F(MotionScene, TheShutterOpensAtTheFrame) {
  // From x = -1 on, a quarter of a frame long
  const auto expected =
      integral([](Place p, double t) { return std::abs(p.x - (t / 2 - 1)) < 0.5 && std::abs(p.y) < 0.5; });
  const std::string text = with_shutter(scene(R"({ "model": "sheet", "position": "[2*time - 7, 0, 0]" })"), "0.25");
  LoadOptions options;
  options.frame = 3;
  expect_near(coverage(text, options), expected, 0.05, 0.005);
}

TEST_F(MotionScene, TheCommandLineMayOpenOrCloseTheShutter) {
  const std::string text = scene(R"({ "model": "sheet", "position": "[2*time - 1, 0, 0]" })");
  for (const char* length : {"0", "0.25"}) {
    LoadOptions options;
    options.shutter = std::stod(length);
    EXPECT_EQ(coverage(text, options), coverage(with_shutter(text, length))) << length;
  }
}

TEST_F(MotionScene, ACameraThatMovesSeesWhatMovesTheOtherWay) {
  const std::string turned = R"("from": "a = 0.15*time; [10*sin(a), time, 10*cos(a)]", "to": "[0, time, 0]")";
  const auto by_camera = coverage(scene(R"({ "model": "sheet" })", "", "", turned)),
             by_object = coverage(
                 scene(R"({ "model": "sheet", "position": "[0, -time, 0]", "rotate": [0, "-0.15*time*180/PI", 0] })"));
  expect_near(by_camera, by_object, 0.03, 0.001);
  EXPECT_NE(by_camera, coverage(scene(R"({ "model": "sheet" })")));
}

// The box is as high as in the middle of the moment: rows are covered by whole moments.
TEST_F(MotionScene, GrowthGoesByMoments) {
  const std::string grows = R"(, "post": { "base": { "type": "box", "size": ["0.5", "0.2 + 0.8*time", 1e-4] } })";
  const auto found = coverage(scene(R"({ "model": "post" })", grows, R"(, "shutter_moments": 4)"));
  const auto expected = integral([](Place p, double t) {
    const double middle = (std::floor(t * 4) + 0.5) / 4;
    return std::abs(p.x) < 0.25 && p.y > 0 && p.y < 0.2 + 0.8 * middle;
  });
  expect_near(found, expected, 0.02, 0.001);
}

// Rules and placements, and what is strewn.
TEST_F(MotionScene, WhatIsStrewnMayChange) {
  const std::string models = R"(,
    "post": { "base": { "type": "prism", "sides": 4, "radius": 0.05, "height": 0.1, "cap": "s" }, "steps": [
      { "grow": 1, "rules": { "s": { "template": "segment", "length": "0.1 + 0.8*time", "taper": 1 } } },
      { "subdivide": 1, "place": "[0.1*time, 0, 0]" } ] },
    "ground": { "base": { "type": "plane", "width": 4, "depth": 0.5 } },
    "posts": { "scatter": [ { "model": "post" } ], "on": "ground", "density": 4 })";
  const std::string camera = R"("from": [0, 0.3, 10], "to": [0, 0.3, 0])";
  const std::string blurred = scene(R"({ "model": "posts" })", models, "", camera);
  const auto found = coverage(blurred);
  // The middles of eight moments
  std::vector<float> mean(found.size(), 0);
  for (int moment = 0; moment < 8; ++moment) {
    std::string text = with_shutter(blurred, "0");
    for (std::size_t i; (i = text.find("time")) != text.npos;)
      text.replace(i, 4, fmt::format("{}", (moment + 0.5) / 8));
    const auto one = coverage(text);
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += one[i] / 8;
  }
  expect_near(found, mean, 0.05, 0.003);
  EXPECT_GT(*std::ranges::max_element(mean), 0.9f);
}

TEST_F(MotionScene, InMaterialsTimeIsThatOfTheOpening) {
  const auto picture = [&](const std::string& brightness) {
    std::string text = scene(R"({ "model": "ball", "position": "[time - 3, 0, 0]" })",
                             R"(, "ball": { "base": { "type": "sphere" }, "material": "glow" })", R"(, "samples": 4)");
    text.replace(text.find(R"("samples": 256, )"), 16, "");
    text.replace(text.find(R"("type": "normals")"), 17, R"("type": "path")");
    text.insert(1, R"( "materials": { "glow": { "base_weight": 0, "emission_luminance": ")" + brightness + "\" } },");
    LoadOptions options;
    options.frame = 3;
    return film(text, options).develop().pixels;
  };
  EXPECT_EQ(picture("time"), picture("3"));
  EXPECT_NE(picture("time"), picture("3.01"));
}

TEST_F(MotionScene, WhatGlowsAndMovesIsNoLightThatStandsStill) {
  const std::string glow = R"(, "lamp": { "base": { "type": "box" }, "material": "glow" })";
  const auto lights = [&](const std::string& object) {
    std::string text = scene(object, glow);
    text.insert(1, R"( "materials": { "glow": { "emission_luminance": 5 } },)");
    return load(text).scene->lights.size();
  };
  EXPECT_GT(lights(R"({ "model": "lamp" })"), 0u);
  EXPECT_EQ(lights(R"({ "model": "lamp", "position": "[time, 0, 0]" })"), 0u);
}

TEST_F(MotionScene, MotionVectorsAreInPixelsAFrame) {
  LoadOptions options;
  options.aovs = {Aov::Motion, Aov::ObjectId};
  const auto at = [&](const Film& film, double x, double y, Aov aov) {
    const Image image = film.develop(aov);
    const int px = int(width / 2. + x * pixels_a_metre), py = int(height / 2. - y * pixels_a_metre);
    const float* p = &image.pixels[std::size_t((py * width + px) * image.channels)];
    return Vec2f{p[0], image.channels > 1 ? p[1] : 0};
  };
  const std::string objects = R"({ "model": "sheet", "position": "[0.2*time - 1.5, 0.1*time, 0]" },
    { "model": "sheet", "position": [1.5, 0, 0] })";
  const Film moving = film(scene(objects), options);
  ASSERT_EQ(at(moving, -1.5, 0, Aov::ObjectId).x, 1);
  EXPECT_NEAR(at(moving, -1.5, 0, Aov::Motion).x, 2, 1e-3);
  EXPECT_NEAR(at(moving, -1.5, 0, Aov::Motion).y, -1, 1e-3);
  EXPECT_EQ(at(moving, 1.5, 0, Aov::Motion), Vec2f());
  EXPECT_EQ(at(moving, 0, 1, Aov::Motion), Vec2f());  // nothing there
  const Film panned = film(scene(objects, "", "", R"("from": "[0.3*time, 0, 10]", "to": "[0.3*time, 0, 0]")"), options);
  EXPECT_NEAR(at(panned, -1.5, 0, Aov::Motion).x, -1, 1e-3);
  EXPECT_NEAR(at(panned, -1.5, 0, Aov::Motion).y, -1, 1e-3);
  EXPECT_NEAR(at(panned, 1.3, 0, Aov::Motion).x, -3, 1e-3);
  // Without a shutter they are the same
  EXPECT_NEAR(at(film(with_shutter(scene(objects), "0"), options), -1.5, 0, Aov::Motion).x, 2, 1e-3);
}

TEST_F(MotionScene, WithoutAShutterTimeIsTheFrame) {
  LoadOptions options;
  options.frame = 1;
  const std::string timed = with_shutter(scene(R"({ "model": "sheet", "position": "[time/2, 0, 0]" })"), "0"),
                    still = with_shutter(scene(R"({ "model": "sheet", "position": [0.5, 0, 0] })"), "0");
  EXPECT_EQ(coverage(timed, options), coverage(still));
  EXPECT_FALSE(load(timed).scene->moves);
}

TEST_F(MotionScene, MistakesAreFoundAtAllTimes) {
  EXPECT_EQ(error(scene(R"({ "model": "sheet", "position": "[tme, 0, 0]" })")),
            "unknown variable \"tme\"; did you mean \"time\"?");
  EXPECT_EQ(error(scene(R"({ "model": "sheet", "position": "[frame, 0, 0]" })")),
            "unknown variable \"frame\"; known: time");
  EXPECT_EQ(error(scene(R"({ "model": "sheet", "scale": "0.5 - time" })")),
            "at time 0.5: \"scale\" is a number or [x, y, z], none of them 0");
  EXPECT_EQ(error(scene(R"({ "model": "sheet" })", "", "", R"("shift_x": "10 + time")")),
            "at time 0.0625: \"shift_x\" of camera \"pinhole\" is 10.0625; expected -10 to 10");
  EXPECT_EQ(
      error(scene(R"({ "model": "post" })", R"(, "post": { "base": { "type": "prism", "radius": "0.5 - time" } })")),
      "at time 0.5625: \"radius\" of base \"prism\" is -0.0625; expected 1e-06 to 1000000 m");
  EXPECT_EQ(
      error(scene(R"({ "model": "pair" })", R"(, "pair": { "group": [ { "model": "sheet", "rotate": "tim" } ] })")),
      "unknown variable \"tim\"; did you mean \"time\"?");
}

}  // namespace
}  // namespace meristem
