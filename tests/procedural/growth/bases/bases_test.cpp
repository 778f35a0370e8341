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

}  // namespace
}  // namespace meristem::test
