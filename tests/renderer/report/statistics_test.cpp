#include "renderer/report/statistics.h"

#include "renderer/language/jsonc_reader.h"
#include "renderer/report/version.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace meristem {
namespace {

RenderStatistics sample_statistics() {
  RenderStatistics s;
  s.scene = "a \"quoted\" scene.jsonc";
  s.scene_sha256 = std::string(64, 'a');
  s.command = "meristem render";
  s.expand = "lazy";
  s.wall_s = 2.5;
  s.load_s = 0.25;
  s.render_s = 2;
  s.first_pixel_s = 0.375;
  s.peak_rss_bytes = 3u << 20;
  s.threads = 2;
  s.rays = {.camera = 1000000, .bounce = 2000000, .shadow = 3000000, .escaped = 7};
  s.samples = 16;
  s.samples_taken = 640 * 360 * 16;
  s.image = {640, 360, 5, std::string(64, 'b')};
  s.expansion.cells_expanded = 1234;
  s.expansion.faces = 5678901;
  s.expansion.waits = 3;
  s.expansion.invalid_rays = 4;
  s.expansion.limbo_bytes_peak = 5;
  s.expansion.plan_bytes = 6;
  s.expansion.defects = {"a cell left its bounds"};
  s.expansion.by_step = {{"oak", "grow 0", 34, 900, 0.125}, {"oak", "subdivide 1", 1200, 5678001, 1.5}};
  return s;
}

double at(const Value& object, std::initializer_list<const char*> path) {
  const Value* v = &object;
  for (const char* key : path) v = v ? v->find(key) : nullptr;
  return v ? v->number : -1;
}

TEST(RenderStatistics, JsonHoldsEveryFigureUnderItsName) {
  Diagnostics diagnostics;
  const auto source = std::make_shared<SourceText>(SourceText{"stats.json", statistics_json(sample_statistics())});
  const Value v = read_jsonc(source, diagnostics);
  ASSERT_FALSE(diagnostics.has_errors()) << source->text;
  EXPECT_EQ(v.find("scene")->text, "a \"quoted\" scene.jsonc");
  EXPECT_EQ(at(v, {"wall_s"}), 2.5);
  EXPECT_EQ(at(v, {"first_pixel_s"}), 0.375);
  EXPECT_EQ(at(v, {"load_s"}), 0.25);
  EXPECT_EQ(at(v, {"render_s"}), 2);
  EXPECT_EQ(at(v, {"peak_rss_bytes"}), 3 << 20);
  EXPECT_EQ(at(v, {"threads"}), 2);
  EXPECT_EQ(at(v, {"rays", "shadow"}), 3e6);
  EXPECT_EQ(at(v, {"rays", "total"}), 6e6);
  EXPECT_EQ(at(v, {"rays_per_s"}), 3e6);
  EXPECT_EQ(at(v, {"samples"}), 16);
  EXPECT_EQ(at(v, {"image", "nonfinite"}), 5);
  EXPECT_EQ(v.find("image")->find("sha256")->text, std::string(64, 'b'));
  EXPECT_EQ(at(v, {"expansion", "cells_expanded"}), 1234);
  EXPECT_EQ(at(v, {"expansion", "waits"}), 3);
  EXPECT_EQ(at(v, {"expansion", "invalid_rays"}), 4);
  EXPECT_EQ(at(v, {"expansion", "limbo_bytes_peak"}), 5);
  EXPECT_EQ(at(v, {"expansion", "plan_bytes"}), 6);
  const Value& defects = *v.find("expansion")->find("defects");
  ASSERT_EQ(defects.items.size(), 1u);
  EXPECT_EQ(defects.items[0].text, "a cell left its bounds");
  const Value& steps = *v.find("expansion")->find("by_step");
  ASSERT_EQ(steps.items.size(), 2u);
  EXPECT_EQ(steps.items[1].find("model")->text, "oak");
  EXPECT_EQ(steps.items[1].find("step")->text, "subdivide 1");
  EXPECT_EQ(at(steps.items[1], {"faces"}), 5678001);
}

TEST(RenderStatistics, WithoutAPixelThereIsNoFirstPixel) {
  RenderStatistics s = sample_statistics();
  s.first_pixel_s.reset();
  EXPECT_NE(statistics_json(s).find("\"first_pixel_s\": null"), std::string::npos);
  EXPECT_NE(summary(s).find("first pixel never"), std::string::npos);
}

TEST(RenderStatistics, TextIsForPeople) {
  EXPECT_EQ(summary(sample_statistics()),
            "640 x 360 pixels, 16 samples in 2.50 s (first pixel 0.38 s), 6,000,000 rays at 3.00 M/s, 3.0 MiB at most; "
            "expanded 1,234 cells to 5,678,901 faces");
  RenderStatistics stopped = sample_statistics();
  stopped.samples_taken = 640 * 360 * 11 / 2;
  EXPECT_TRUE(summary(stopped).starts_with("640 x 360 pixels, 5.5 of 16 samples in 2.50 s")) << summary(stopped);
  EXPECT_NE(details(sample_statistics()).find("subdivide 1"), std::string::npos);
  EXPECT_EQ(format_bytes(1023), "1023 B");
  EXPECT_EQ(format_bytes(std::uint64_t(3) << 40), "3.0 TiB");
  EXPECT_EQ(format_count(0), "0");
  EXPECT_EQ(format_count(999), "999");
  EXPECT_EQ(format_count(1000), "1,000");
  EXPECT_EQ(format_count(123456789), "123,456,789");
}

TEST(RenderStatistics, TheImageDigestDependsOnEveryBit) {
  Image image{2, 1, 3, {0, 1, 2, 3, 4, 5}};
  const std::string digest = image_sha256(image);
  image.pixels[0] = -0.0f;
  EXPECT_NE(image_sha256(image), digest);
  // sha256sum of the four bytes 00 00 80 3f
  EXPECT_EQ(image_sha256({1, 1, 1, {1.0f}}), "e00e5eb9444182f352323374ef4e08ebcb784725fdd4fd612d7730540b3e0c8c");
}

TEST(Version, IsThatOfTheBuildFiles) {
  std::ifstream in(MERISTEM_SOURCE_DIR "/CMakeLists.txt");
  std::stringstream text;
  text << in.rdbuf();
  EXPECT_NE(text.str().find(std::string("VERSION ") + version + " LANGUAGES"), std::string::npos);
}

}  // namespace
}  // namespace meristem
