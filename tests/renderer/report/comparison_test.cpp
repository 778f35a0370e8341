#include "renderer/report/comparison.h"

#include "renderer/report/child_process.h"
#include "tests/renderer/image/scratch_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

namespace meristem {
namespace {

TEST(ChildProcess, ReturnsTheExitCodeOrTheSignal) {
  EXPECT_EQ(run_child({"/bin/sh", "-c", "exit 0"}), 0);
  EXPECT_EQ(run_child({"/bin/sh", "-c", "exit 7"}), 7);
  EXPECT_EQ(run_child({"/bin/sh", "-c", "kill -TERM $$"}), 143);
  EXPECT_EQ(run_child({"/bin/sh", "-c", "kill -INT $$"}), 130);
  EXPECT_THROW(run_child({"/nowhere/program"}), std::runtime_error);
}

// Stands in for the renderer: copies a prepared image and statistics of the mode, and notes how it was called.
//   $1 render, $2 scene, $3 --expand, $4 mode, $5 -o, $6 image, $7 --float, $8 --stats, $9 stats, ...
class FakeRenderer {
 public:
  FakeRenderer() {
    write_file(folder_ / "renderer", "#!/bin/sh\nD=" + (folder_ / "") +
                                         "\necho \"$@\" >> $D/calls\n"
                                         "if [ -f $D/$4.code ]; then exit $(cat $D/$4.code); fi\n"
                                         "cp $D/$4.exr $6 && cp $D/$4.json $9\n"
                                         "if [ -f $D/$4.end ]; then exit $(cat $D/$4.end); fi\n");
    std::filesystem::permissions(folder_ / "renderer", std::filesystem::perms::owner_all);
    for (const char* mode : {"lazy", "eager", "flat"}) prepare(mode, {2, 1, 4, {1, 2, 3, 1, 4, 5, 6, 1}}, 100);
  }
  void prepare(const std::string& mode, const Image& image, int faces) const {
    write_image(folder_ / (mode + ".exr"), image, {}, {.half = false});
    write_file(folder_ / (mode + ".json"),
               "{\"wall_s\": 2.5, \"first_pixel_s\": 0.5, \"peak_rss_bytes\": 1048576, \"image\": {\"sha256\": \"x\"}, "
               "\"expansion\": {\"faces\": " +
                   std::to_string(faces) + ", \"cells_expanded\": 4, \"resident_bytes_peak\": 8000}}");
  }
  void fail(const std::string& mode, int code) const { write_file(folder_ / (mode + ".code"), std::to_string(code)); }
  // Ends so, with an image.
  void end(const std::string& mode, int code) const { write_file(folder_ / (mode + ".end"), std::to_string(code)); }
  ComparisonOptions options(int runs) const {
    ComparisonOptions o;
    o.program = folder_ / "renderer";
    o.scene = "scene.jsonc";
    o.render_options = {"--samples", "4"};
    o.runs = runs;
    return o;
  }
  std::string calls() const { return read_text(folder_ / "calls"); }

 private:
  ScratchFolder folder_;
};

TEST(Comparison, GathersFiguresAndDifferences) {
  const FakeRenderer renderer;
  renderer.prepare("flat", {2, 1, 4, {1, 2, 3, 1, 4, 5.5f, 6, 1}}, 900);
  const Comparison c = compare_modes(renderer.options(1));
  ASSERT_EQ(c.variants.size(), 3u);
  EXPECT_EQ(c.exit_code(), 0);
  EXPECT_EQ(c.pixels, 2u);
  EXPECT_EQ(c.variants[0].median(&RunFigures::wall_s), 2.5);
  EXPECT_EQ(c.variants[0].median(&RunFigures::first_pixel_s), 0.5);
  EXPECT_FALSE(c.variants[0].difference);
  EXPECT_TRUE(c.variants[1].difference->identical());
  EXPECT_EQ(c.variants[2].median(&RunFigures::faces), 900u);
  EXPECT_EQ(c.variants[2].difference->differing, 1u);
  EXPECT_EQ(c.variants[2].difference->max, 0.5);
  const std::string table = comparison_table(c), json = comparison_json(c);
  EXPECT_NE(table.find("flat                         0.50 s     2.50 s      1.0 MiB              900          0.5      "
                       "  0.177            1"),
            std::string::npos)
      << table;
  EXPECT_NE(json.find("\"differing_pixels\": 1"), std::string::npos) << json;
}

TEST(Comparison, ModesTakeTurnsAndOptionsArePassedOn) {
  const FakeRenderer renderer;
  EXPECT_EQ(compare_modes(renderer.options(2)).variants[2].runs.size(), 2u);
  const std::string end = "--quiet --samples 4\n";
  std::string order;
  std::istringstream calls(renderer.calls());
  for (std::string line; std::getline(calls, line);) {
    const std::size_t mode = line.find("--expand ") + 9;
    order += line.substr(mode, line.find(' ', mode) - mode + 1);
    EXPECT_TRUE((line + '\n').ends_with(end)) << line;
  }
  EXPECT_EQ(order, "lazy eager flat lazy eager flat ");
}

TEST(Comparison, BudgetsAreSharesOfWhatAllGeometryTakes) {
  const FakeRenderer renderer;
  ComparisonOptions options = renderer.options(1);
  options.budgets = {{.share = 0.25}, {.bytes = 1000}};
  const Comparison c = compare_modes(options);
  ASSERT_EQ(c.variants.size(), 5u);
  EXPECT_EQ(c.variants[1].budget.bytes, 2000u);
  EXPECT_EQ(c.variants[1].name, "lazy 25 % (2.0 KiB)");
  EXPECT_EQ(c.variants[2].name, "lazy 1000 B");
  EXPECT_NE(renderer.calls().find("--quiet --samples 4 --budget 2000\n"), std::string::npos) << renderer.calls();
  EXPECT_NE(renderer.calls().find("--quiet --samples 4 --budget 1000\n"), std::string::npos);
}

TEST(Comparison, RecordedRenderingsAreNotTimed) {
  const FakeRenderer renderer;
  ComparisonOptions options = renderer.options(1);
  options.record = true;
  const Comparison c = compare_modes(options);
  EXPECT_TRUE(c.variants[0].statistics && c.variants[1].statistics);
  EXPECT_FALSE(c.variants[2].statistics);
  EXPECT_EQ(c.variants[0].runs.size(), 1u);
  EXPECT_NE(renderer.calls().find("--samples 4 --profile\n"), std::string::npos) << renderer.calls();
}

TEST(Comparison, SaysInWordsWhatItShows) {
  const FakeRenderer renderer;
  renderer.prepare("flat", {2, 1, 4, {1, 2, 3, 1, 0, 5.5f, 6, 1}}, 900);
  const std::vector<std::string> words = comparison_words(compare_modes(renderer.options(1)));
  ASSERT_EQ(words.size(), 3u);
  EXPECT_EQ(words[0],
            "Against eager, lazy shows its first pixel 1.0 times sooner (after 0.50 s, not 0.50 s), is done 1.0 "
            "times sooner, and holds 0 % less memory.");
  EXPECT_TRUE(words[2].starts_with("Not all images are the same: flat differs from lazy in 1 of 2 pixels")) << words[2];
}

TEST(Comparison, AFailedModeIsReportedAndTheOthersGoOn) {
  const FakeRenderer renderer;
  renderer.fail("eager", 1);
  const Comparison c = compare_modes(renderer.options(2));
  EXPECT_EQ(c.exit_code(), 1);
  EXPECT_EQ(c.variants[1].runs.size(), 0u);
  EXPECT_EQ(c.variants[2].runs.size(), 2u);
  EXPECT_NE(comparison_table(c).find("eager                  failed with exit code 1"), std::string::npos);
}

TEST(Comparison, AWrongSceneIsToldOnce) {
  const FakeRenderer renderer;
  for (const char* mode : {"lazy", "eager", "flat"}) renderer.fail(mode, 2);
  const Comparison c = compare_modes(renderer.options(3));
  EXPECT_EQ(c.exit_code(), 2);
  EXPECT_EQ(std::ranges::count(renderer.calls(), '\n'), 1) << renderer.calls();
}

TEST(Comparison, FaultsAreSaidAndTheImageIsCompared) {
  const FakeRenderer renderer;
  renderer.end("flat", 3);
  const Comparison c = compare_modes(renderer.options(1));
  EXPECT_EQ(c.exit_code(), 3);
  EXPECT_TRUE(c.variants[2].difference->identical());
  EXPECT_NE(comparison_table(c).find("flat: rendered with faults"), std::string::npos);
}

TEST(Comparison, AnInterruptionEndsIt) {
  const FakeRenderer renderer;
  renderer.fail("eager", 130);
  const Comparison c = compare_modes(renderer.options(2));
  EXPECT_EQ(c.exit_code(), 130);
  EXPECT_EQ(c.variants[0].runs.size(), 1u);
  EXPECT_EQ(c.variants[2].runs.size(), 0u);
}

}  // namespace
}  // namespace meristem
