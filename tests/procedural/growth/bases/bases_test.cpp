#include "geometry/mesh/refine.h"
#include "tests/procedural/growth/derivation.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace meristem::test {
namespace {

double volume(const Mesh& mesh) {
  double sum = 0;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto c = mesh.corners(f);
    for (std::size_t i = 1; i + 1 < c.size(); ++i)
      sum += dot(mesh.positions[c[0]], cross(mesh.positions[c[i]], mesh.positions[c[i + 1]])) / 6;
  }
  return sum;
}

Mesh built(const std::string& text) {
  const Derivation d(text, {});
  EXPECT_EQ(d.messages(), std::vector<std::string>{});
  EXPECT_EQ(manifold_defect(d.base), "") << text;
  EXPECT_EQ(d.base.corner_uv.size(), d.base.corner_vertices.size());
  EXPECT_EQ(std::set<Key>(d.base.face_keys.begin(), d.base.face_keys.end()).size(), d.base.face_count());
  EXPECT_EQ(std::set<Key>(d.base.vertex_keys.begin(), d.base.vertex_keys.end()).size(), d.base.vertex_count());
  return d.base;
}

TEST(Bases, SolidsAreClosedAndTurnOutwards) {
  const Mesh prism = built(R"json({ "type": "prism", "sides": 6, "radius": 2, "height": 3 })json");
  EXPECT_TRUE(is_closed(prism));
  EXPECT_NEAR(volume(prism), 3 * std::sqrt(3.0) / 2 * 4 * 3, 1e-6);
  const Mesh box = built(R"json({ "type": "box", "size": [2, 3, 4] })json");
  EXPECT_TRUE(is_closed(box));
  EXPECT_NEAR(volume(box), 24, 1e-6);
  const Mesh sphere = built(R"json({ "type": "sphere", "radius": 2, "divisions": 16 })json");
  EXPECT_TRUE(is_closed(sphere));
  EXPECT_EQ(sphere.face_count(), 6u * 256);
  EXPECT_EQ(euler_characteristic(sphere), 2);
  EXPECT_NEAR(volume(sphere), 4.0 / 3 * pi * 8, 0.2);
  for (Vec3d p : sphere.positions) EXPECT_NEAR(length(p), 2, 1e-8);
}

TEST(Bases, PrismHasTheUOfThePaper) {
  const Derivation d(octagon, {});
  const std::uint32_t cap = faces_with(d.base, d.symbols->find("shoot")).at(0);
  const double u[] = {0, .5, 1, .5, 0, .5, 1, .5};
  ASSERT_EQ(d.base.corner_count(cap), 8u);
  for (std::uint32_t i = 0; i < 8; ++i) EXPECT_EQ(d.base.corner_uv[d.base.face_starts[cap] + i], (Vec2d{u[i], 1}));
  EXPECT_NEAR(face_frame(d.base, cap).z.y, 1, 1e-12);
}

TEST(Bases, PlanesAreSquareUnlessTheirDepthIsGiven) {
  const Mesh square = built(R"json({ "type": "plane", "width": 3, "columns": 4 })json");
  const Mesh spelt_out = built(R"json({ "type": "plane", "width": 3, "depth": 3, "columns": 4, "rows": 4 })json");
  EXPECT_EQ(square.face_count(), 16u);
  EXPECT_EQ(square.positions, spelt_out.positions);
}

TEST(Bases, PlaneLooksUpAndIsOpen) {
  const Mesh plane = built(R"json({ "type": "plane", "width": 3, "depth": 2, "columns": 3, "rows": 4 })json");
  EXPECT_EQ(plane.face_count(), 12u);
  EXPECT_FALSE(is_closed(plane));
  double area = 0;
  for (std::uint32_t f = 0; f < 12; ++f) {
    EXPECT_GT(newell_normal(plane, f).y, 0);
    area += newell_normal(plane, f).y / 2;
  }
  EXPECT_NEAR(area, 6, 1e-9);
}

TEST(Bases, CreasesAgreeOnBothFaces) {
  const Mesh box = built(R"json({ "type": "box", "crease": 2 })json");
  EXPECT_EQ(box.corner_sharpness, std::vector<float>(24, 2.f));
  const Mesh prism = built(R"json({ "type": "prism", "sides": 5, "crease": 2 })json");
  EXPECT_EQ(std::count(prism.corner_sharpness.begin(), prism.corner_sharpness.end(), 2.f),
            20);  // both rims, from both sides
  EXPECT_TRUE(built(R"json({ "type": "box" })json").corner_sharpness.empty());
}

TEST(Bases, ParametersOfSymbolsAreEvaluatedForEachFace) {
  const Derivation d(R"json({ "type": "sphere", "divisions": 4, "face": "bud(2*3, rand())" })json", {});
  std::set<float> drawn;
  for (const FaceOrigin& o : d.base.origins) {
    EXPECT_EQ(o.parameters[0], 6);
    drawn.insert(o.parameters[1]);
  }
  EXPECT_GT(drawn.size(), 90u);
}

const std::string tetrahedron =
    R"json({ "type": "mesh", "vertices": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]],
    "polygons": [[0,2,1],[0,1,3],[1,2,3],[0,3,2]],
"names": ["x","y","y"], )json";

TEST(Bases, MeshTakesSymbolsByNamesAndCreases) {
  const Derivation d(tetrahedron + R"json("symbols": { "y": "bud(3)" }, "creases": [[0, 1, 2.5]] })json", {});
  EXPECT_EQ(d.messages(), std::vector<std::string>{});
  EXPECT_EQ(faces_with(d.base, d.symbols->find("bud")), (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(std::count(d.base.corner_sharpness.begin(), d.base.corner_sharpness.end(), 2.5f), 2);
  EXPECT_EQ(Derivation(tetrahedron + R"json("symbols": { "yy": "bud(3)" } })json", {}).messages().at(0).substr(0, 42),
            "3:38 the mesh has no face named \"yy\"");
}

TEST(Bases, MeshReadsObjFilesBesideTheScene) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "meristem_bases_test";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "t.obj")
      << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\ng foot\nf 1 3 2\ng tip\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
  const Derivation d(R"json({ "type": "mesh", "file": "t.obj", "symbols": { "tip": "bud" } })json", {}, 1,
                     folder.string());
  EXPECT_EQ(d.messages(), std::vector<std::string>{});
  EXPECT_EQ(faces_with(d.base, d.symbols->find("bud")).size(), 3u);
  EXPECT_TRUE(is_closed(d.base));
  std::filesystem::remove_all(folder);
}

// A vertex may be another place on the texture for each of its faces; what grows on one keeps to that.
TEST(Bases, MeshFilesKeepTheSeamsOfTextures) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "meristem_seams_test";
  std::filesystem::create_directories(folder);
  const std::string points = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt .25 .5\n";
  std::ofstream(folder / "seam.obj") << points + "g a\nf 1/1 2/2 3/3\ng b\nf 1/4 3/3 4/4\n";
  std::ofstream(folder / "none.obj") << points + "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";
  std::ofstream(folder / "part.obj") << points + "f 1/2 2/2 3/3\nf 1 3 4\n";
  const auto base = [&](const std::string& file) {
    Derivation d(R"json({ "type": "mesh", "file": ")json" + file + "\" }", {}, 1, folder.string());
    EXPECT_EQ(d.messages(), std::vector<std::string>{});
    return d.base;
  };
  const Mesh seam = base("seam.obj");
  EXPECT_TRUE(has_seams(seam));
  EXPECT_EQ(seam.vertex_count(), 4u);
  EXPECT_EQ(seam.corner_uv[0], (Vec2d{0, 0}));
  EXPECT_EQ(seam.corner_uv[3], (Vec2d{.25, .5}));
  EXPECT_EQ(seam.uv[0], (Vec2d{.125, .25})) << "what placements see";
  EXPECT_FALSE(has_seams(base("none.obj")));
  const Mesh part = base("part.obj");
  EXPECT_TRUE(has_seams(part)) << "faces without coordinates lie at (0, 0)";
  EXPECT_EQ(part.corner_uv[3], (Vec2d{}));
  EXPECT_EQ(part.corner_uv[0], (Vec2d{1, 0}));

  const Derivation d(
      R"json({ "type": "mesh", "file": "seam.obj", "symbols": { "b": "bud" } })json",
      {R"json({ "grow": 1, "rules": { "bud": { "template": "extrude", "faces": { "cap": "bud" } } } })json"},
      1, folder.string());
  EXPECT_EQ(d.messages(), std::vector<std::string>{});
  CellMesh cell, grown;
  cell.mesh = d.base;
  cell.owned_faces = 2;
  d.steps.at(0)->apply(cell, 0, grown);
  const Mesh& mesh = grown.mesh;
  EXPECT_TRUE(has_seams(mesh));
  ASSERT_EQ(mesh.corner_uv.size(), mesh.corner_vertices.size());
  EXPECT_EQ(mesh.uv.size(), mesh.vertex_count());
  EXPECT_EQ(mesh.seam_widths.size(), mesh.face_count());
  EXPECT_GT(mesh.face_count(), 4u);
  for (std::size_t c = 3; c < mesh.corner_uv.size(); ++c) EXPECT_GE(mesh.corner_uv[c].x, .25) << c;
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace meristem::test
