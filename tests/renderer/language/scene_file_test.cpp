#include "renderer/language/scene_file.h"
#include "renderer/language/scene_text.h"

#include "messages.h"
#include "renderer/language/json_writer.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace meristem {
namespace {

namespace fs = std::filesystem;
using namespace testing;

// Scene files in a folder of the test's own: root/scene is the scene's folder, root/outside is not.
class SceneFileTest : public ::testing::Test {
 protected:
  SceneFileTest() {
    const std::string name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    root_ = fs::temp_directory_path() / ("meristem_scene_file_" + std::to_string(::getpid()) + "_" + name);
    fs::create_directories(root_ / "scene" / "library");
    write("outside.jsonc", "{}");
  }
  ~SceneFileTest() override { fs::remove_all(root_); }

  void write(const std::string& path, const std::string& text) { std::ofstream(root_ / path) << text; }

  // Reads scene/main.jsonc; fills messages_.
  Value read() {
    Diagnostics diagnostics;
    Value v = read_scene_file((root_ / "scene/main.jsonc").string(), diagnostics);
    messages_ = messages_of(diagnostics);
    return v;
  }
  std::string errors_including(const std::string& include) {
    write("scene/main.jsonc", "{ \"include\": " + include + " }");
    read();
    return messages_;
  }

  fs::path root_;
  std::string messages_;
};

TEST_F(SceneFileTest, ReadsAFileThatIncludesNothing) {
  write("scene/main.jsonc", "{ \"format\": 1, \"models\": { \"a\": 1 } }");
  EXPECT_EQ(to_json(read()), R"({ "format": 1, "models": { "a": 1 } })");
  EXPECT_EQ(messages_, "");
}

TEST_F(SceneFileTest, MergesMaterialsAndModels) {
  write("scene/main.jsonc",
        R"({ "include": ["library/trees.jsonc", "metals.jsonc"], "models": { "own": 1 }, "camera": {} })");
  write("scene/library/trees.jsonc", R"({ "format": 1, "include": "bark.jsonc", "models": { "oak": 2 } })");
  write("scene/library/bark.jsonc", R"({ "materials": { "bark": 3 } })");
  write("scene/metals.jsonc", R"({ "materials": { "iron": 4 } })");
  EXPECT_EQ(to_json(read()),
            R"({ "models": { "oak": 2, "own": 1 }, "camera": {}, "materials": { "bark": 3, "iron": 4 } })");
  EXPECT_EQ(messages_, "");
}

TEST_F(SceneFileTest, PlacesPointIntoTheIncludedFile) {
  write("scene/main.jsonc", R"({ "include": "library/bark.jsonc" })");
  write("scene/library/bark.jsonc", "{\n \"materials\": { \"bark\": 3 } }");
  const Value v = read();
  const Location& place = v.find("materials")->find("bark")->location;
  EXPECT_EQ(place.source->name, (root_ / "scene/library/bark.jsonc").string());
  EXPECT_EQ(place.line(), 2);
  EXPECT_EQ(place.column(), 25);
}

TEST_F(SceneFileTest, ReadsAFileIncludedTwiceOnce) {
  write("scene/main.jsonc", R"({ "include": ["a.jsonc", "b.jsonc", "./library/../c.jsonc"] })");
  write("scene/a.jsonc", R"({ "include": "c.jsonc" })");
  write("scene/b.jsonc", R"({ "include": "./c.jsonc" })");
  write("scene/c.jsonc", R"({ "models": { "oak": 2 } })");
  EXPECT_EQ(to_json(read()), R"({ "models": { "oak": 2 } })");
  EXPECT_EQ(messages_,
            "1:37: cannot use the file \"./library/../c.jsonc\": \"..\" is not allowed; files must stand in the "
            "scene's folder\n");
}

TEST_F(SceneFileTest, ReportsNamesDefinedTwice) {
  write("scene/main.jsonc", "{ \"include\": \"a.jsonc\",\n  \"models\": { \"oak\": 1 } }");
  write("scene/a.jsonc", R"({ "models": { "oak": 2 } })");
  read();
  EXPECT_EQ(messages_,
            "2:15: \"oak\" stands twice in \"models\"; first at " + (root_ / "scene/a.jsonc").string() + ":1:15\n");
}

TEST_F(SceneFileTest, ReportsWhatDoesNotBelongIntoAnIncludedFile) {
  write("scene/a.jsonc", R"({ "camera": {}, "models": [] })");
  EXPECT_EQ(errors_including("\"a.jsonc\""),
            "1:3: an included file has no \"camera\"; known: format, include, materials, models; the rest belongs into "
            "the scene itself\n"
            "1:27: \"models\": expected an object of named models, found an array\n");
  write("scene/a.jsonc", "[]");
  EXPECT_EQ(errors_including("\"a.jsonc\""), "1:1: an included file: expected an object, found an array\n");
  write("scene/a.jsonc", R"({ "format": 2 })");
  EXPECT_EQ(errors_including("\"a.jsonc\""), "1:13: this program reads \"format\": 1 only\n");
  EXPECT_EQ(errors_including("[1, {}]"),
            "1:15: \"include\": expected a file name or a list of them, found a number\n"
            "1:18: \"include\": expected a file name or a list of them, found an object\n");
}

TEST_F(SceneFileTest, StaysInsideTheScenesFolder) {
  const std::string absolute = (root_ / "outside.jsonc").string();
  EXPECT_EQ(errors_including("\"../outside.jsonc\""),
            "1:14: cannot use the file \"../outside.jsonc\": \"..\" is not allowed; files must stand in the scene's "
            "folder\n");
  EXPECT_EQ(errors_including("\"" + absolute + "\""),
            "1:14: cannot use the file \"" + absolute + "\": expected a path relative to the scene's folder\n");
  fs::create_symlink(root_ / "outside.jsonc", root_ / "scene/link.jsonc");
  EXPECT_EQ(errors_including("\"link.jsonc\""),
            "1:14: cannot use the file \"link.jsonc\": it lies outside the scene's folder\n");
  fs::create_directory_symlink(root_, root_ / "scene/up");
  EXPECT_EQ(errors_including("\"up/outside.jsonc\""),
            "1:14: cannot use the file \"up/outside.jsonc\": it lies outside the scene's folder\n");
  fs::create_directories(root_ / "scene2");
  write("scene2/a.jsonc", "{}");
  fs::create_directory_symlink(root_ / "scene2", root_ / "scene/twin");
  EXPECT_EQ(errors_including("\"twin/a.jsonc\""),
            "1:14: cannot use the file \"twin/a.jsonc\": it lies outside the scene's folder\n");
}

TEST_F(SceneFileTest, FollowsLinksThatStayInside) {
  write("scene/library/a.jsonc", "{}");
  fs::create_symlink("library/a.jsonc", root_ / "scene/link.jsonc");
  EXPECT_EQ(errors_including("\"link.jsonc\""), "");
}

TEST_F(SceneFileTest, OpensRegularFilesOnly) {
  EXPECT_EQ(errors_including("\"library\""), "1:14: cannot use the file \"library\": not a regular file\n");
  ASSERT_EQ(::mkfifo((root_ / "scene/pipe").c_str(), 0600), 0);
  EXPECT_EQ(errors_including("\"pipe\""), "1:14: cannot use the file \"pipe\": not a regular file\n");
  EXPECT_EQ(errors_including("\"none.jsonc\""),
            "1:14: cannot use the file \"none.jsonc\": No such file or directory\n");
  EXPECT_EQ(errors_including("\"\""), "1:14: cannot use the file \"\": not a file name\n");
}

TEST_F(SceneFileTest, ReportsCycles) {
  write("scene/a.jsonc", R"({ "include": "b.jsonc" })");
  write("scene/b.jsonc", R"({ "include": "a.jsonc" })");
  EXPECT_EQ(errors_including("\"a.jsonc\""), "1:14: \"a.jsonc\" includes itself: a.jsonc -> b.jsonc -> a.jsonc\n");
  EXPECT_EQ(errors_including("\"main.jsonc\""), "1:14: \"main.jsonc\" includes itself: main.jsonc -> main.jsonc\n");
}

TEST_F(SceneFileTest, BoundsDepthAndNumber) {
  for (int i = 0; i < 20; ++i)
    write("scene/d" + std::to_string(i) + ".jsonc", "{ \"include\": \"d" + std::to_string(i + 1) + ".jsonc\" }");
  write("scene/d20.jsonc", "{}");
  EXPECT_EQ(errors_including("\"d0.jsonc\""), "1:14: more than 16 files include each other in a row\n");
  EXPECT_EQ(errors_including("\"d5.jsonc\""), "");
  std::string names = "[";
  for (int i = 0; i < 257; ++i) {
    write("scene/n" + std::to_string(i) + ".jsonc", "{}");
    names += "\"n" + std::to_string(i) + ".jsonc\",\n";
  }
  EXPECT_EQ(errors_including(names + "]"), "257:1: more than 256 files are included\n");
}

TEST_F(SceneFileTest, ReportsScenesThatCannotBeRead) {
  read();
  EXPECT_EQ(messages_,
            "0:0: cannot open \"" + (root_ / "scene/main.jsonc").string() + "\": No such file or directory\n");
  Diagnostics diagnostics;
  EXPECT_EQ(load_scene_text(root_.string(), diagnostics), nullptr);
  EXPECT_EQ(messages_of(diagnostics),
            "0:0: cannot read \"" + root_.string() + "\": it is a folder; expected a scene file in it\n");
}

TEST_F(SceneFileTest, ReadsStreams) {
  Diagnostics diagnostics;
  std::istringstream stream("{}");
  const auto source = load_stream_text(stream, "<stdin>", diagnostics);
  ASSERT_NE(source, nullptr);
  EXPECT_EQ(source->name, "<stdin>");
  EXPECT_EQ(source->text, "{}");
}

TEST_F(SceneFileTest, BoundsTheBytesOfAStream) {
  Diagnostics diagnostics;
  std::istringstream stream(std::string(JsoncLimits::file_bytes + 1, ' '));
  EXPECT_EQ(load_stream_text(stream, "<stdin>", diagnostics), nullptr);
  EXPECT_EQ(messages_of(diagnostics), "0:0: \"<stdin>\" is longer than 64 MiB\n");
}

}  // namespace
}  // namespace meristem
