#include "renderer/interchange/mesh_scene.h"

#include "renderer/loading/load_scene.h"
#include "tests/renderer/interchange/folder.h"

#include <gtest/gtest.h>

#include <cmath>

namespace meristem {
namespace {

const std::string header =
    "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n"
    "property list uchar int vertex_indices\nend_header\n";

struct Converted {
  ForeignScene scene;
  std::vector<std::string> messages;
};
Converted convert(const std::string& path) {
  Diagnostics diagnostics;
  Converted c{read_mesh_scene(path, diagnostics), {}};
  for (const Diagnostic& d : diagnostics.list()) c.messages.push_back(d.message);
  return c;
}

// A square whose diagonal has a vertex twice, since its colours differ there: red to black on one side, black on the
// other.
TEST(MeshScene, ColorsOfVerticesAreSeen) {
  const Folder folder("mesh_scene");
  const std::string path = folder.write("scan.ply", header +
                                                        "0 0 0 255 0 0\n1 0 0 255 0 0\n1 1 0 0 0 0\n0 0 0 0 0 0\n"
                                                        "0 1 0 0 0 0\n3 0 1 2\n3 3 2 4\n");
  Converted c = convert(path);
  EXPECT_TRUE(c.messages.empty()) << c.messages.at(0);
  const PolygonMesh& mesh = *c.scene.models.at(0).mesh;
  EXPECT_EQ(mesh.positions.size(), 4u) << "one surface";
  EXPECT_EQ(mesh.face_count(), 2u);

  ASSERT_EQ(mesh.corner_uv.size(), 6u);
  const auto u = [&](std::size_t corner) { return mesh.uv[mesh.corner_uv[corner]].x; };
  EXPECT_EQ(u(0), u(1));
  EXPECT_NEAR(std::abs(u(0) - u(2)), 1, 1e-9);
  for (std::size_t corner = 3; corner < 6; ++corner) EXPECT_NEAR(u(corner), u(2), 1e-9);
  const std::string color = c.scene.materials.at(0).value.find("base_color")->text;
  EXPECT_NE(color.find(" + u*["), std::string::npos) << color;
  EXPECT_EQ(color.find("v*"), std::string::npos) << color;

  // And the scene is one
  AssetFolder assets(folder.file("scan.jsonc"));
  Diagnostics diagnostics;
  complete_foreign_scene(c.scene, diagnostics);
  write_foreign_scene(c.scene, folder.file("scan.jsonc"), assets);
  LoadOptions options;
  options.check_only = true;
  EXPECT_EQ(load_scene(folder.file("scan.jsonc"), options).scene->names.materials.back(), "scan");
}

TEST(MeshScene, WhatIsNoManifoldIsCut) {
  const Folder folder("mesh_scene");
  const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 -1\nf 1 2 3\nf 1 2 4\nf 1 2 5\n";
  const Converted c = convert(folder.write("fan.obj", text));
  ASSERT_EQ(c.messages.size(), 1u);
  EXPECT_NE(c.messages[0].find("4 more vertices"), std::string::npos) << c.messages[0];
  EXPECT_EQ(c.scene.models.at(0).mesh->positions.size(), 9u);
  EXPECT_EQ(c.scene.models.at(0).name, "fan");
}

TEST(MeshScene, TexturesGoBeforeColors) {
  const Folder folder("mesh_scene");
  const Converted c = convert(
      folder.write("both.obj", "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"));
  ASSERT_EQ(c.messages.size(), 1u);
  EXPECT_EQ(c.messages[0], "colours of vertices were left out, since the mesh has texture coordinates");
  EXPECT_EQ(c.scene.models.at(0).mesh->uv[1], (Vec2d{1, 0}));
}

TEST(MeshScene, ABrokenFileIsAnError) {
  const Folder folder("mesh_scene");
  Diagnostics diagnostics;
  EXPECT_THROW(read_mesh_scene(folder.write("none.obj", "v 0 0 0\n"), diagnostics), SceneErrors);
}

}  // namespace
}  // namespace meristem
