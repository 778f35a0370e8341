// Mistakes that beginners make in models: each is said at its place, with what would have been right.
#include "renderer/loading/load_scene.h"
#include "tests/renderer/interchange/folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace meristem {
namespace {

// "file:line message" of the first of them, and how many there are.
struct Said {
  std::string first;
  std::size_t count = 0;
};

Said load(const Folder& folder, const std::string& models, const std::string& more = "") {
  const std::string path = folder.write("scene.jsonc", fmt::format(R"({{ "models": {{ {} }}, {}
    "objects": [ {{ "model": "m" }} ], "camera": {{ "from": [0, 0, 4], "to": [0, 0, 0] }} }})",
                                                                   models, more));
  LoadOptions options;
  options.check_only = true;
  std::vector<Diagnostic> list;
  try {
    list = load_scene(path, options).warnings;
  } catch (const SceneErrors& e) {
    list = e.list();
  }
  if (list.empty()) return {};
  const Location& at = list[0].location;
  return {fmt::format("{}:{} {}", at.source->name.substr(at.source->name.rfind('/') + 1), at.line(), list[0].message),
          list.size()};
}

TEST(Mistakes, TheSchemeLoopNeedsTriangles) {
  const Folder folder("mistakes");
  const std::string triangle =
      R"("m": { "base": { "type": "mesh", "vertices": [[0,0,0],[1,0,0],[0,1,0]], "polygons": [[0,1,2]] }, "steps": )";
  const std::string loop = R"({ "subdivide": 1,
  "scheme": "loop" })";
  EXPECT_EQ(load(folder, triangle + "[ " + loop + ", " + loop + R"(, { "subdivide": 1 } ] })").first, "");
  EXPECT_EQ(load(folder, triangle + R"([ { "subdivide": 1 }, )" + loop + " ] }").first.substr(0, 47),
            "scene.jsonc:2 the scheme loop needs triangles, ");
  const Said box = load(folder, R"("m": { "base": { "type": "box" }, "steps": [ )" + loop + " ] }");
  EXPECT_EQ(box.first,
            "scene.jsonc:2 the scheme loop needs triangles, and faces here have 4 corners; leave \"scheme\" out for "
            "that of Catmull and Clark, which takes all");
  EXPECT_EQ(box.count, 1u);
}

TEST(Mistakes, FilesThatAreNoManifold) {
  const Folder folder("mistakes");
  folder.write("turned.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 3 4\n");
  const Said turned = load(folder, R"("m": { "base": { "type": "mesh", "file": "turned.obj" } })");
  EXPECT_EQ(turned.first.substr(0, 82),
            "turned.obj:6 this face goes along the edge from vertex 2 to 3, as that of line 5 d");
  EXPECT_EQ(turned.count, 1u);
  // Two triangles that meet in a point alone
  folder.write("bow.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv -1 0 0\nv 0 -1 0\nf 1 2 3\nf 1 4 5\n");
  const Said bow = load(folder, R"("m": { "base": { "type": "mesh", "file": "bow.obj" } })");
  EXPECT_NE(bow.first.find("`meristem convert` cuts such files apart"), std::string::npos) << bow.first;
  EXPECT_EQ(bow.count, 1u);
}

TEST(Mistakes, EndingsOfFilesMayBeCapital) {
  const Folder folder("mistakes");
  folder.write("LEAF.OBJ", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(load(folder, R"("m": { "base": { "type": "mesh", "file": "LEAF.OBJ" } })").first, "");
}

TEST(Mistakes, ColorsOfVerticesAreNotShownWithoutAWord) {
  const Folder folder("mistakes");
  folder.write("scan.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n");
  EXPECT_EQ(
      load(folder, R"("m": { "base": { "type": "mesh", "file": "scan.obj" } })").first,
      "scene.jsonc:1 the colours of the vertices of \"scan.obj\" are not shown: `meristem convert` makes a scene of "
      "such a file that has them");
}

TEST(Mistakes, ColorsAsOnWebPages) {
  const Folder folder("mistakes");
  EXPECT_EQ(
      load(folder, R"("m": { "base": { "type": "box" } })", R"("materials": { "red": { "base_color": "#ff0000" } },)")
          .first,
      "scene.jsonc:1 expected a value; '#' begins a comment, and a colour is [r, g, b] from 0 to 1");
}

TEST(Mistakes, AScatterOfNothing) {
  const Folder folder("mistakes");
  EXPECT_EQ(load(folder, R"("g": { "base": { "type": "plane" } }, "m": { "scatter": [], "on": "g" })").first,
            "scene.jsonc:1 \"scatter\" is an array of one or more {\"model\": name}, found an array");
}

}  // namespace
}  // namespace meristem
