// The whole program but the reading of scenes, for which a loader of the tests stands in.
#include "renderer/cli/command_line.h"

#include "renderer/color/color.h"
#include "renderer/language/jsonc_reader.h"
#include "tests/renderer/image/scratch_folder.h"
#include "tests/renderer/session/fake_scene.h"

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>

#include <unistd.h>

namespace meristem {
namespace {

Spectrum gradient_light(const Ray& ray, Sampler&, RayCounts&) {
  return {ray.origin.x * 0.25f, ray.origin.y * 0.125f, 0.18f};
}

class WorldWithFailures : public EmptyWorld {
 public:
  ExpansionStatistics statistics() const override {
    ExpansionStatistics s;
    s.failed = 2;
    s.defects = {"a cell left its bounds"};
    return s;
  }
};

class CommandLineTest : public testing::Test {
 protected:
  // Runs `meristem` with these arguments, in the scratch folder. Fills out_ and error_.
  int run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "meristem");
    std::vector<const char*> argv;
    for (const std::string& a : arguments) argv.push_back(a.c_str());
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(folder_ / "");
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code =
        run_command_line(int(argv.size()), argv.data(),
                         [this](const std::string& path, const LoadOptions& options) { return load(path, options); });
    out_ = testing::internal::GetCapturedStdout();
    error_ = testing::internal::GetCapturedStderr();
    std::filesystem::current_path(before);
    return code;
  }

  LoadedScene load(const std::string& path, const LoadOptions& options) {
    loaded_path_ = path;
    load_options_ = options;
    if (path == "broken.jsonc") throw SceneErrors({{Diagnostic::Severity::Error, {}, "all is wrong"}});
    LoadedScene loaded{
        fake_scene(options.width.value_or(16), options.height.value_or(8), options.samples.value_or(4), light_),
        std::string(64, 'c'),
        {}};
    loaded.warnings.push_back({Diagnostic::Severity::Warning, {}, "a small doubt"});
    if (failures_) loaded.scene->intersector = std::make_unique<WorldWithFailures>();
    return loaded;
  }

  Value statistics() {
    Diagnostics diagnostics;
    return read_jsonc(std::make_shared<SourceText>(SourceText{"s", read_text(folder_ / "s.json")}), diagnostics);
  }

  ScratchFolder folder_;
  FunctionIntegrator::Function light_ = gradient_light;
  bool failures_ = false;
  std::string loaded_path_, out_, error_;
  LoadOptions load_options_;
};

TEST_F(CommandLineTest, RenderWritesAnExrAndAPngNamedAfterTheScene) {
  ASSERT_EQ(run({"render", "some/folder/plant.jsonc"}), 0) << error_;
  EXPECT_EQ(loaded_path_, "some/folder/plant.jsonc");
  const Image exr = read_image(folder_ / "plant.exr"), png = read_image(folder_ / "plant.png");
  EXPECT_EQ(exr.channels, 4);
  EXPECT_EQ(exr.width, 16);
  EXPECT_NEAR(exr.pixels[2], 0.18f, 1e-4f);
  std::vector<float> shown{exr.pixels[0], exr.pixels[1], exr.pixels[2]};
  DisplayTransform("ACES SDR").apply(shown.data(), 1, 1, 3);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(png.pixels[c], shown[c], 0.004f) << c;
  EXPECT_EQ(folder_.files(), 2u);
  EXPECT_NE(error_.find("a small doubt"), std::string::npos);
  EXPECT_EQ(out_, "");
}

TEST_F(CommandLineTest, EveryOptionArrives) {
  ASSERT_EQ(run({"render",      "a.jsonc", "--samples", "2",        "--size",   "20x10",   "--threads", "1",
                 "--budget",    "64M",     "--expand",  "flat",     "--camera", "side",    "--seed",    "7",
                 "--max-depth", "3",       "--crop",    "2,3,12,9", "--float",  "--quiet", "--stats",   "s.json",
                 "-o",          "a.exr",   "-o",        "b.tif",    "--bits",   "16",      "--view",    "Raw",
                 "--exposure",  "1",       "--shutter", "0.25"}),
            0)
      << error_;
  EXPECT_EQ(load_options_.samples, 2);
  EXPECT_EQ(load_options_.budget_bytes, 64u << 20);
  EXPECT_EQ(load_options_.expand, ExpandMode::Flat);
  EXPECT_EQ(load_options_.camera, "side");
  EXPECT_EQ(load_options_.seed, 7u);
  EXPECT_EQ(load_options_.max_depth, 3);
  EXPECT_EQ(load_options_.shutter, 0.25);
  EXPECT_EQ(load_options_.threads, 1);
  EXPECT_EQ(error_, "");
  const Image exr = read_image(folder_ / "a.exr"), tif = read_image(folder_ / "b.tif");
  EXPECT_EQ(exr.width, 10);
  EXPECT_EQ(exr.height, 6);
  EXPECT_EQ(exr.pixels[2], 0.18f);
  EXPECT_NEAR(tif.pixels[2], 0.36f, 1e-5f);
  const Value s = statistics();
  EXPECT_EQ(s.find("samples")->number, 2);
  EXPECT_EQ(s.find("samples_taken")->number, 10 * 6 * 2);
  EXPECT_EQ(s.find("expand")->text, "flat");
  EXPECT_EQ(s.find("scene_sha256")->text, std::string(64, 'c'));
  EXPECT_GT(s.find("peak_rss_bytes")->number, 1e6);
  EXPECT_GT(s.find("first_pixel_s")->number, 0);
  EXPECT_GE(s.find("wall_s")->number, s.find("first_pixel_s")->number);
  EXPECT_EQ(s.find("rays")->find("camera")->number, 120);
  EXPECT_EQ(folder_.files(), 3u);
}

TEST_F(CommandLineTest, ProbeTellsOfOnePixel) {
  ASSERT_EQ(run({"probe", "a.jsonc", "3,5", "--samples", "2", "--size", "20x10"}), 0) << error_;
  EXPECT_NE(out_.find("pixel 3,5 of 20 x 10\n  no surface\n"), std::string::npos) << out_;
  EXPECT_NE(out_.find("sample 1: radiance"), std::string::npos) << out_;
  EXPECT_NE(out_.find("camera   nothing"), std::string::npos) << out_;
  EXPECT_EQ(folder_.files(), 0u);
  EXPECT_EQ(run({"probe", "a.jsonc", "3,10", "--size", "20x10"}), 2);
  EXPECT_NE(error_.find("outside the image of 20 x 10"), std::string::npos) << error_;
  EXPECT_NE(run({"probe", "a.jsonc"}), 0);
  EXPECT_NE(run({"probe", "a.jsonc", "3"}), 0);
}

TEST_F(CommandLineTest, TheDigestDoesNotDependOnThreads) {
  std::string digest;
  for (const char* threads : {"1", "2", "8"}) {
    ASSERT_EQ(run({"render", "a.jsonc", "--threads", threads, "--stats", "s.json", "-q"}), 0);
    const std::string now = statistics().find("image")->find("sha256")->text;
    EXPECT_TRUE(digest.empty() || now == digest) << threads;
    digest = now;
  }
}

TEST_F(CommandLineTest, UsageErrorsEndAsTwoBeforeAnythingIsLoaded) {
  const std::vector<std::vector<std::string>> wrong{{},
                                                    {"paint"},
                                                    {"render"},
                                                    {"render", "a.jsonc", "--sample", "4"},
                                                    {"render", "a.jsonc", "--samples", "0"},
                                                    {"render", "a.jsonc", "--samples", "many"},
                                                    {"render", "a.jsonc", "--size", "640"},
                                                    {"render", "a.jsonc", "--budget", "lots"},
                                                    {"render", "a.jsonc", "--shutter", "1.5"},
                                                    {"render", "a.jsonc", "--crop", "5,5,1,1"},
                                                    {"render", "a.jsonc", "--expand", "partly"},
                                                    {"render", "a.jsonc", "--half", "--float"},
                                                    {"render", "a.jsonc", "--quiet", "--verbose"},
                                                    {"render", "a.jsonc", "-o", "a.gif"},
                                                    {"render", "a.jsonc", "-o", "a.png", "--view", "Filmic"},
                                                    {"render", "a.jsonc", "b.jsonc"},
                                                    {"compare", "-"},
                                                    {"compare", "a.jsonc", "--runs", "0"},
                                                    {"describe", "no such component"},
                                                    {"describe", "sky", "--markdown"}};
  for (const auto& arguments : wrong) {
    EXPECT_EQ(run(arguments), 2) << testing::PrintToString(arguments);
    EXPECT_NE(error_, "") << testing::PrintToString(arguments);
  }
  EXPECT_EQ(loaded_path_, "");
  EXPECT_EQ(folder_.files(), 0u);
}

TEST_F(CommandLineTest, AWrongWordIsAnsweredWithTheOneThatWasMeant) {
  const auto answer = [&](const std::vector<std::string>& arguments) {
    EXPECT_EQ(run(arguments), 2);
    return error_.substr(0, error_.find('\n'));
  };
  EXPECT_TRUE(
      answer({"rendr", "a.jsonc"}).starts_with("no command \"rendr\"; did you mean \"render\"?; there are: render,"))
      << error_;
  EXPECT_EQ(answer({"render", "a.jsonc", "--sampels", "4"}),
            "render has no option --sampels; did you mean \"--samples\"?");
  EXPECT_EQ(answer({"render", "a.jsonc", "--sampels=4"}),
            "render has no option --sampels; did you mean \"--samples\"?");
  EXPECT_EQ(answer({"merge", "a.film", "-o", "b.exr", "--xyz"}), "merge has no option --xyz");
  EXPECT_EQ(answer({"render", "a.jsonc", "b.jsonc"}), "render: \"b.jsonc\" is one argument too many");
  EXPECT_EQ(answer({"render", "a.jsonc", "--expand", "partly"}),
            "--expand: \"partly\" is not known: expected one of eager, flat, lazy");
}

TEST_F(CommandLineTest, OfAnOptionGivenTwiceTheLastCounts) {
  ASSERT_EQ(run({"render", "a.jsonc", "--samples", "4", "--size", "8x8", "--expand", "flat", "--samples", "2", "--size",
                 "4x4", "--expand", "lazy", "-q", "-q"}),
            0)
      << error_;
  EXPECT_EQ(load_options_.samples, 2);
  EXPECT_EQ(load_options_.width, 4);
  EXPECT_EQ(load_options_.expand, ExpandMode::Lazy);
}

TEST_F(CommandLineTest, HelpNamesACommandOrAComponent) {
  ASSERT_EQ(run({"--help"}), 0);
  const std::string all = out_;
  ASSERT_EQ(run({"help"}), 0);
  EXPECT_EQ(out_, all);
  ASSERT_EQ(run({"render", "--help"}), 0);
  const std::string render = out_;
  ASSERT_EQ(run({"help", "render"}), 0);
  EXPECT_EQ(out_, render);
  ASSERT_EQ(run({"describe", "sky"}), 0);
  const std::string sky = out_;
  ASSERT_EQ(run({"help", "sky"}), 0);
  EXPECT_EQ(out_, sky);
  EXPECT_EQ(run({"help", "skyy"}), 2);
  EXPECT_NE(error_.find("did you mean \"sky\"?"), std::string::npos) << error_;
}

TEST_F(CommandLineTest, SceneErrorsEndAsTwo) {
  for (const char* command : {"render", "check"}) {
    EXPECT_EQ(run({command, "broken.jsonc"}), 2);
    EXPECT_NE(error_.find("all is wrong"), std::string::npos);
  }
  EXPECT_EQ(run({"render", "a.jsonc", "--crop", "100,100,200,200"}), 2);
  EXPECT_NE(error_.find("outside the image"), std::string::npos);
}

TEST_F(CommandLineTest, FileErrorsEndAsFourBeforeAnythingIsRendered) {
  std::filesystem::create_symlink("/dev/full", folder_ / "full.exr");
  for (const char* output : {"missing/a.exr", "full.exr"}) {
    EXPECT_EQ(run({"render", "a.jsonc", "-o", output}), 4);
    EXPECT_NE(error_.find(output), std::string::npos) << error_;
  }
  EXPECT_EQ(run({"render", "a.jsonc", "--stats", "missing/s.json"}), 4);
  EXPECT_EQ(loaded_path_, "");
}

TEST_F(CommandLineTest, WhatACommandReadsIsNotWrittenOver) {
  const std::string scene = "{ \"camera\": {} }";
  write_file(folder_ / "a.jsonc", scene);
  std::filesystem::create_symlink("a.jsonc", folder_ / "link.jsonc");
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"render", "a.jsonc", "--stats", "a.jsonc"},
                                                    {"render", "a.jsonc", "--trace", "./a.jsonc"},
                                                    {"render", "a.jsonc", "--stats", "link.jsonc"},
                                                    {"profile", "a.jsonc", "-o", "a.jsonc"},
                                                    {"compare", "a.jsonc", "-o", "a.jsonc"}}) {
    EXPECT_EQ(run(arguments), 2) << testing::PrintToString(arguments);
    EXPECT_NE(error_.find("it is what the command reads"), std::string::npos) << error_;
  }
  EXPECT_EQ(run({"render", "a.jsonc", "-o", "b.png", "--stats", "b.png"}), 2);
  EXPECT_NE(error_.find("b.png is named for two outputs"), std::string::npos) << error_;
  EXPECT_EQ(run({"render", "a.jsonc", "-o", "b.png", "-o", "./b.png"}), 2);
  write_file(folder_ / "a.glb", "not read at all");
  EXPECT_EQ(run({"convert", "a.glb", "-o", "a.glb"}), 2);
  EXPECT_EQ(read_text(folder_ / "a.jsonc"), scene);
  EXPECT_EQ(read_text(folder_ / "a.glb"), "not read at all");
}

TEST_F(CommandLineTest, OneFileThatCannotBeWrittenDoesNotCostTheOthers) {
  light_ = [&](const Ray&, Sampler&, RayCounts&) {  // the folder goes away while rays are traced
    std::filesystem::remove(folder_ / "gone");
    return Spectrum(0.5f);
  };
  std::filesystem::create_directory(folder_ / "gone");
  EXPECT_EQ(
      run({"render", "a.jsonc", "-o", "a.exr", "-o", "gone/b.exr", "-o", "c.exr", "-o", "gone/d.png", "-o", "e.png"}),
      4);
  for (const char* name : {"gone/b.exr", "gone/d.png"}) EXPECT_NE(error_.find(name), std::string::npos) << error_;
  for (const char* name : {"a.exr", "c.exr", "e.png"}) EXPECT_TRUE(std::filesystem::exists(folder_ / name)) << name;
  EXPECT_NE(error_.find("--resume writes the images from a.film"), std::string::npos) << error_;
  EXPECT_EQ(run({"render", "a.jsonc", "-o", "a.exr", "-o", "e.png", "--resume"}), 0) << error_;
  EXPECT_NE(error_.find("going on from a.film"), std::string::npos) << error_;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.film"));
}

TEST_F(CommandLineTest, TheCommandLineIsKeptAsItIsTyped) {
  ASSERT_EQ(run({"render", "a.jsonc", "--set", "/a=it's [1, 2]", "--stats", "s.json", "-q"}), 0) << error_;
  EXPECT_EQ(statistics().find("command")->text,
            R"(meristem render a.jsonc --set '/a=it'\''s [1, 2]' --stats s.json -q)");
}

TEST_F(CommandLineTest, AFullDiskEndsAsFourAndTheOldFilesStay) {
  ASSERT_EQ(run({"render", "a.jsonc", "--stats", "s.json"}), 0);
  const std::string exr = read_text(folder_ / "a.exr"), png = read_text(folder_ / "a.png"),
                    stats = read_text(folder_ / "s.json");
  {
    const FileSizeLimit limit(50);
    for (const char* output : {"a.exr", "a.png"})
      EXPECT_EQ(run({"render", "a.jsonc", "--samples", "1", "-o", output, "-q"}), 4);
  }
  {
    const FileSizeLimit limit(300);
    EXPECT_EQ(run({"render", "a.jsonc", "--samples", "1", "--size", "1x1", "-o", "one.png", "--stats", "s.json", "-q"}),
              4);
  }
  // Not compared by EXPECT_EQ: its message would hold the files
  EXPECT_TRUE(read_text(folder_ / "a.exr") == exr);
  EXPECT_TRUE(read_text(folder_ / "a.png") == png);
  EXPECT_TRUE(read_text(folder_ / "s.json") == stats);
}

TEST_F(CommandLineTest, FaultsWhileRenderingEndAsThreeWithTheImageWritten) {
  light_ = [](const Ray& ray, Sampler&, RayCounts&) { return Spectrum(ray.origin.x < 1 ? std::nanf("") : 1.0f); };
  EXPECT_EQ(run({"render", "a.jsonc", "-o", "a.exr"}), 3);
  EXPECT_NE(error_.find("32 samples were not finite"), std::string::npos) << error_;
  for (float value : read_image(folder_ / "a.exr").pixels) EXPECT_TRUE(std::isfinite(value));
  light_ = gradient_light;
  failures_ = true;
  EXPECT_EQ(run({"render", "a.jsonc", "-o", "b.exr"}), 3);
  EXPECT_NE(error_.find("2 cells"), std::string::npos);
  EXPECT_NE(error_.find("warning: a cell left its bounds"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "b.exr"));
}

TEST_F(CommandLineTest, ASignalEndsTheRenderWithTheImageSoFar) {
  for (const auto& [number, code] : {std::pair(SIGINT, 130), std::pair(SIGTERM, 143)}) {
    std::atomic<int> taken{0};
    light_ = [&taken, signal_number = number](const Ray&, Sampler&, RayCounts&) {
      if (++taken == 200) std::raise(signal_number);
      return Spectrum(0.5f);
    };
    EXPECT_EQ(run({"render", "a.jsonc", "--samples", "100000", "-o", "a.exr", "--stats", "s.json"}), code);
    const Image image = read_image(folder_ / "a.exr");
    for (std::size_t i = 0; i < image.pixels.size(); i += 4) EXPECT_EQ(image.pixels[i], 0.5f);
    EXPECT_TRUE(statistics().find("interrupted")->boolean);
  }
}

TEST_F(CommandLineTest, WhatBreaksInsideEndsAsOne) {
  light_ = [](const Ray&, Sampler&, RayCounts&) -> Spectrum { throw std::logic_error("a bug"); };
  EXPECT_EQ(run({"render", "a.jsonc"}), 1);
  EXPECT_NE(error_.find("a bug"), std::string::npos);
  EXPECT_EQ(folder_.files(), 0u);
}

TEST_F(CommandLineTest, HalfOverflowIsSaid) {
  light_ = [](const Ray&, Sampler&, RayCounts&) { return Spectrum(1e6f); };
  EXPECT_EQ(run({"render", "a.jsonc", "-o", "a.exr"}), 0);
  EXPECT_NE(error_.find("384 values clamped"), std::string::npos) << error_;
}

TEST_F(CommandLineTest, CheckSaysWhatWasLoaded) {
  EXPECT_EQ(run({"check", "a.jsonc"}), 0);
  EXPECT_NE(out_.find("a.jsonc: no errors, 1 warnings"), std::string::npos) << out_;
  EXPECT_NE(out_.find("16 x 8 pixels"), std::string::npos);
  EXPECT_EQ(folder_.files(), 0u);
}

TEST_F(CommandLineTest, HelpVersionDescriptionAndSchemaGoToStandardOutput) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--help"},
                                                    {"--version"},
                                                    {"render", "--help"},
                                                    {"describe"},
                                                    {"describe", "--markdown"},
                                                    {"schema"}}) {
    EXPECT_EQ(run(arguments), 0);
    EXPECT_NE(out_, "") << arguments[0];
    EXPECT_EQ(error_, "");
  }
}

}  // namespace
}  // namespace meristem
