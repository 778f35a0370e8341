#include "renderer/loading/scene_files.h"

#include "geometry/base/sha256.h"
#include "renderer/language/scene_file.h"
#include "renderer/loading/load_part.h"
#include "tests/renderer/image/scratch_folder.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

class SceneFilesTest : public testing::Test {
 protected:
  Value read(const std::string& text) {
    std::ofstream(folder_ / "a.jsonc") << text;
    Diagnostics diagnostics;
    Value scene = read_scene_file(folder_ / "a.jsonc", diagnostics);
    EXPECT_FALSE(diagnostics.has_errors());
    return scene;
  }
  ScratchFolder folder_;
};

TEST_F(SceneFilesTest, TextsAreTheSceneAndWhatItIncludes) {
  const std::string library = R"({ "materials": { "chalk": {} } })";
  const std::string scene = R"({ "include": "b.jsonc", "camera": {} })";
  std::ofstream(folder_ / "b.jsonc") << library;
  const auto texts = scene_texts(read(scene));
  ASSERT_EQ(texts.size(), 2u);
  EXPECT_EQ(texts[0], std::pair(std::string("scene"), sha256(scene)));
  EXPECT_EQ(texts[1], std::pair(std::string("b.jsonc"), sha256(library)));
}

TEST_F(SceneFilesTest, FilesAreThoseThatAreThere) {
  std::filesystem::create_directory(folder_ / "meshes");
  std::ofstream(folder_ / "meshes/rock.obj") << "v 0 0 0\n";
  std::ofstream(folder_ / "sky.exr") << "no image";
  const Value scene = read(R"({ "models": { "m": { "base": { "type": "mesh", "file": "meshes/rock.obj" } } },
    "lights": [ { "file": "sky.exr" }, { "file": "sky.exr" }, { "file": "gone.exr" }, { "color": "0.5*P" } ] })");
  const auto files = named_files(scene, folder_ / "");
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[0].first, "meshes/rock.obj");
  EXPECT_EQ(files[1].first, "sky.exr");
  EXPECT_EQ(read_text(files[1].second), "no image");
}

TEST_F(SceneFilesTest, ObjectsAreNamedByThemselvesOrTheirModels) {
  const Value scene = read(R"({ "objects": [ { "model": "oak" }, { "model": "ash", "name": "old one" },
    { "model": "elm" }, { "model": "oak" }, { "model": "ash" } ] })");
  const std::vector<std::string> expected{"oak 1", "old one", "elm", "oak 2", "ash"};
  EXPECT_EQ(object_names(*scene.find("objects")), expected);
}

}  // namespace
}  // namespace meristem
