#include "renderer/interchange/export_scene.h"

#include "geometry/io/mesh_file.h"
#include "renderer/image/atomic_file.h"
#include "renderer/interchange/material_looks.h"
#include "renderer/language/jsonc_reader.h"
#include "tests/renderer/interchange/folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

namespace meristem {
namespace {

namespace fs = std::filesystem;

// A branch whose cells are many, seen from so near that its levels of detail are mixed.
constexpr const char* branch = R"scene({
  "materials": { "bark": { "base_color": "mix([.1, .2, .3], [.3, .2, .1], u)" }, "red": { "base_color": [0.5, 0, 0] } },
  "models": {
    "branch": {
      "base": { "type": "prism", "sides": 6, "radius": 0.25, "height": 1, "cap": "shoot(1)" }, "material": "bark",
      "steps": [ { "grow": 3, "rules": { "shoot(len)": { "template": "segment", "length": "len", "taper": 0.9,
                   "faces": { "cap": "shoot(0.9*len)" } } } },
                 { "subdivide": 2 }, { "subdivide": 3, "place": "0.3*scale*N*noise(8*P)" } ] },
    "box": { "base": { "type": "box" }, "material": "red" },
    "pair": { "group": [ { "model": "box" }, { "model": "box", "position": [2, 0, 0], "scale": [-1, 1, 1] } ] } },
  "objects": [ OBJECTS ],
  "camera": { "from": [1, 2, 1.5], "to": [0, 1.5, 0], "fov": 60 },
  "render": { "size": [320, 180], "detail": DETAIL } })scene";

LoadedScene load(const Folder& folder, const std::string& objects, const std::string& detail) {
  std::string text = branch;
  text.replace(text.find("OBJECTS"), 7, objects);
  text.replace(text.find("DETAIL"), 6, detail);
  folder.write("scene.jsonc", text);
  LoadOptions options;
  options.check_only = options.keep_objects = true;
  return load_scene(folder.file("scene.jsonc"), options);
}

ExportFigures write(const LoadedScene& scene, const std::string& path) {
  return export_scene(scene,
                      *make_mesh_writer(path, MaterialLooks(*scene.scene).any_varies(), scene.scene->names.materials),
                      [](double, std::uint64_t) {});
}

PolygonMesh read(const std::string& path) {
  Diagnostics diagnostics;
  PolygonMesh mesh = load_mesh(path, {}, diagnostics);
  for (const Diagnostic& d : diagnostics.list()) ADD_FAILURE() << d.formatted();
  return mesh;
}

// Edges that are passed more often in one direction than in the other.
std::size_t open_edges(const PolygonMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const std::uint32_t first = mesh.face_starts[f], count = mesh.face_starts[f + 1] - first;
    for (std::uint32_t k = 0; k < count; ++k) {
      const std::uint32_t a = mesh.corner_positions[first + k], b = mesh.corner_positions[first + (k + 1) % count];
      balance[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  return std::size_t(std::ranges::count_if(balance, [](const auto& edge) { return edge.second != 0; }));
}

TEST(Export, AClosedModelIsAClosedMeshOfSharedVertices) {
  const Folder folder("export");
  const auto check = [&](const char* detail, const char* name) {
    const ExportFigures figures = write(load(folder, R"({ "model": "branch" })", detail), folder.file(name));
    const PolygonMesh mesh = read(folder.file(name));
    EXPECT_EQ(open_edges(mesh), 0u) << name << ", detail " << detail;
    EXPECT_EQ(mesh.positions.size(), figures.vertices);
    EXPECT_EQ(mesh.face_count(), figures.triangles);
    EXPECT_GT(mesh.face_count(), 8000u);  // several cells
    return mesh;
  };
  const PolygonMesh full = check("0", "mesh.ply");
  EXPECT_EQ(full.positions.size(), full.face_count() / 2 + 2) << "Euler's formula";
  check("0", "mesh.obj");
  check("6", "mesh.ply");  // where levels meet, vertices are shown at others: the surface touches itself
}

// A square whose diagonal is a seam, subdivided: the two triangles stay apart in u, and only there is the mesh open.
TEST(Export, SeamsOfTexturesStay) {
  const Folder folder("export");
  folder.write("seam.obj",
               "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt .25 0\nvt .25 1\nvt .75 0\nvt 1 0\nvt 1 1\n"
               "f 1/1 2/2 3/3\nf 1/4 3/5 4/6\n");
  folder.write("scene.jsonc", R"({ "models": { "m": { "base": { "type": "mesh", "file": "seam.obj" },
    "steps": [ { "subdivide": 2, "place": "[0, 0, .1*snoise(3*P)]" } ] } }, "objects": [ { "model": "m" } ],
    "camera": { "from": [0, 0, 3], "to": [0, 0, 0] }, "render": { "detail": 0 } })");
  LoadOptions options;
  options.check_only = options.keep_objects = true;
  const LoadedScene scene = load_scene(folder.file("scene.jsonc"), options);
  write(scene, folder.file("mesh.obj"));
  const PolygonMesh mesh = read(folder.file("mesh.obj"));
  ASSERT_EQ(mesh.face_count(), 48u);
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const bool is_left = mesh.uv[mesh.corner_uv[3 * f]].x < 0.5;
    for (std::uint32_t c = 3 * f; c < 3 * f + 3; ++c) {
      const double u = mesh.uv[mesh.corner_uv[c]].x;
      EXPECT_TRUE(is_left ? u <= 0.25 : u >= 0.75) << u;
    }
  }
  // 4 edges on each of four sides, and as many on both sides of the seam; positions agree across it
  EXPECT_EQ(open_edges(mesh), 4u * 4 + 2 * 4);
  std::map<std::array<double, 3>, int> places;
  for (const Vec3d& p : mesh.positions) ++places[{p.x, p.y, p.z}];
  EXPECT_EQ(mesh.positions.size() - places.size(), 5u) << "the vertices of the seam stand twice";
}

TEST(Export, LevelOfDetailIsThatOfTheCamera) {
  const Folder folder("export");
  const auto triangles = [&](const char* detail) {
    return write(load(folder, R"({ "model": "branch" })", detail), folder.file("mesh.ply")).triangles;
  };
  const std::uint64_t all = triangles("0"), coarse = triangles("20");
  EXPECT_EQ(all, 2u * 6 * (1 + 3) * 1024 + 2u * 2 * 6 * 256) << "quads of the sides and both caps, after five levels";
  EXPECT_LT(coarse, all / 4);
}

TEST(Export, PlacesBecomeFacesAndMirrorsTurnThem) {
  const Folder folder("export");
  const LoadedScene scene = load(folder, R"({ "model": "pair", "position": [0, 5, 0] })", "0");
  for (const char* name : {"mesh.ply", "mesh.obj"}) {
    const ExportFigures figures = write(scene, folder.file(name));
    EXPECT_EQ(figures.places, 2u);
    const PolygonMesh mesh = read(folder.file(name));
    EXPECT_EQ(mesh.face_count(), 24u);
    EXPECT_EQ(open_edges(mesh), 0u);
    // The volume by the divergence theorem: positive if faces look outwards
    double volume = 0;
    for (std::uint32_t f = 0; f < 24; ++f) {
      const auto p = [&](std::uint32_t k) { return mesh.positions[mesh.corner_positions[3 * f + k]]; };
      volume += dot(p(0), cross(p(1), p(2))) / 6;
    }
    EXPECT_NEAR(volume, 2, 1e-5);
    for (const Vec3d p : mesh.positions) EXPECT_GE(p.y, 4.4);
  }
}

// The two chunks of a .glb file.
struct Glb {
  Value json;
  std::string text, binary;
};
Glb read_glb(const std::string& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  const std::string all = bytes.str();
  const auto number = [&](std::size_t at) {
    std::uint32_t n = 0;
    std::memcpy(&n, all.data() + at, 4);
    return n;
  };
  EXPECT_EQ(number(8), all.size());
  const std::uint32_t json_bytes = number(12);
  Glb glb;
  glb.text = all.substr(20, json_bytes);
  glb.binary = all.substr(28 + json_bytes);
  EXPECT_EQ(number(20 + json_bytes), glb.binary.size());
  Diagnostics diagnostics;
  glb.json = read_jsonc(std::make_shared<SourceText>(SourceText{path, glb.text}), diagnostics);
  for (const Diagnostic& d : diagnostics.list()) ADD_FAILURE() << d.formatted();
  return glb;
}

TEST(Export, GltfSharesTheMeshesOfInstances) {
  const Folder folder("export");
  const LoadedScene scene =
      load(folder, R"({ "model": "pair" }, { "model": "pair", "position": [0, 0, 9] }, { "model": "branch" })", "0");
  const ExportFigures figures = write(scene, folder.file("mesh.glb"));
  EXPECT_EQ(figures.surfaces, 2u);
  EXPECT_EQ(figures.places, 5u);
  const Glb glb = read_glb(folder.file("mesh.glb"));
  EXPECT_EQ(glb.json.find("nodes")->items.size(), 6u);  // and the camera
  ASSERT_EQ(glb.json.find("meshes")->items.size(), 2u);
  EXPECT_EQ(glb.json.find("buffers")->items[0].find("byteLength")->number, double(glb.binary.size()));
  const Value& materials = *glb.json.find("materials");
  EXPECT_EQ(materials.items[2].find("name")->text, "red");
  EXPECT_NEAR(materials.items[2].find("pbrMetallicRoughness")->find("baseColorFactor")->items[0].number, 0.5, 1e-6);
  // Where the material varies the colour is that of the vertices
  const auto attributes = [&](std::size_t mesh) {
    return glb.json.find("meshes")->items[mesh].find("primitives")->items[0].find("attributes");
  };
  EXPECT_FALSE(attributes(0)->find("COLOR_0"));
  EXPECT_TRUE(attributes(1)->find("COLOR_0"));
  double indices = 0;
  for (const Value& accessor : glb.json.find("accessors")->items)
    if (accessor.find("type")->text == "SCALAR") indices += accessor.find("count")->number;
  EXPECT_EQ(indices, 3 * double(figures.triangles));
}

TEST(Export, TheCameraIsTheScenes) {
  const Folder folder("export");
  const LoadedScene scene = load(folder, R"({ "model": "box" })", "0");
  const MeshCamera camera = mesh_camera(*scene.scene);
  const Vec3d back = normalize(Vec3d{1, 0.5, 1.5});
  EXPECT_NEAR(length(camera.to_world.z - back), 0, 1e-5);
  EXPECT_NEAR(length(camera.to_world.origin - Vec3d{1, 2, 1.5}), 0, 1e-5);
  EXPECT_NEAR(camera.to_world.x.y, 0, 1e-5);
  EXPECT_NEAR(camera.to_world.determinant(), 1, 1e-5);
}

TEST(Export, FailuresLeaveNoFile) {
  const Folder folder("export");
  const LoadedScene scene = load(folder, R"({ "model": "box" })", "0");
  EXPECT_THROW(make_mesh_writer(folder.file("nowhere/mesh.ply"), false, {}), FileError);
  { const auto unfinished = make_mesh_writer(folder.file("mesh.ply"), false, {}); }
  EXPECT_FALSE(fs::exists(folder.file("mesh.ply")));
  EXPECT_EQ(make_mesh_writer(folder.file("mesh.stl"), false, {}), nullptr);
}

}  // namespace
}  // namespace meristem
