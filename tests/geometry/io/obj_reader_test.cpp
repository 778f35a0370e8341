#include "geometry/io/obj_reader.h"

#include "geometry/base/key.h"
#include "geometry/io/mesh_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace meristem {
namespace {

struct Result {
  PolygonMesh mesh;
  Diagnostics diagnostics;
};

Result read(const std::string& text) {
  Result r;
  r.mesh = read_obj(std::make_shared<SourceText>(SourceText{"test.obj", text}), r.diagnostics);
  return r;
}

const std::string triangle_points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

// The first error as "line:column message".
std::string first_error(const std::string& text) {
  const Result r = read(text);
  if (r.diagnostics.list().empty()) return {};
  const Diagnostic& d = r.diagnostics.list().front();
  return std::to_string(d.location.line()) + ":" + std::to_string(d.location.column()) + " " + d.message;
}

TEST(ObjReader, ReadsPositionsUvAndPolygons) {
  const Result r = read(
      "# a comment\r\no thing\nv 0 0 0\nv +1.5 -2e1 .5\nv 0 1 0 1\nv 1 1 1\nvt 0.25 0.75 0\nvt 1\nvn 0 0 1\n"
      "s off\nf 1/1/1 2/2/1 3//1\nf 1 2 3 4 # quad\n");
  EXPECT_TRUE(r.diagnostics.list().empty());
  ASSERT_EQ(r.mesh.positions.size(), 4u);
  EXPECT_EQ(r.mesh.positions[1], (Vec3d{1.5, -20, .5}));
  ASSERT_EQ(r.mesh.uv.size(), 2u);
  EXPECT_EQ(r.mesh.uv[0], (Vec2d{.25, .75}));
  EXPECT_EQ(r.mesh.uv[1], (Vec2d{1, 0}));
  EXPECT_EQ(r.mesh.face_starts, (std::vector<std::uint32_t>{0, 3, 7}));
  EXPECT_EQ(r.mesh.corner_positions, (std::vector<std::uint32_t>{0, 1, 2, 0, 1, 2, 3}));
  EXPECT_EQ(r.mesh.corner_uv[1], 1u);
  EXPECT_EQ(r.mesh.corner_uv[2], PolygonMesh::none);
  EXPECT_EQ(r.mesh.names, (std::vector<std::string>{""}));
}

TEST(ObjReader, NegativeIndicesCountFromTheLastVertexSoFar) {
  const Result r = read(triangle_points + "f -3 -2 -1\nv 9 9 9\nf -1 -4 -3\n");
  EXPECT_TRUE(r.diagnostics.list().empty());
  EXPECT_EQ(r.mesh.corner_positions, (std::vector<std::uint32_t>{0, 1, 2, 3, 0, 1}));
}

// As scanners write them, in sRGB; of all vertices or of none. One more number is a weight.
TEST(ObjReader, ReadsColorsBehindPositions) {
  const Result r = read("v 0 0 0 1 0 .5\nv 1 0 0 0 2 0 # green\nv 0 1 0 .04045 0 0\nf 1 2 3\n");
  EXPECT_TRUE(r.diagnostics.list().empty());
  ASSERT_EQ(r.mesh.colors.size(), 3u);
  EXPECT_EQ(r.mesh.colors[0].x, 1);
  EXPECT_NEAR(r.mesh.colors[0].z, 0.2140, 1e-4);
  EXPECT_EQ(r.mesh.colors[1], (Vec3f{0, 1, 0}));
  EXPECT_NEAR(r.mesh.colors[2].x, 0.04045 / 12.92, 1e-6);
  EXPECT_TRUE(read("v 0 0 0 1 0 .5\nv 1 0 0\nv 0 1 0 1 1 1\nf 1 2 3\n").mesh.colors.empty());
  EXPECT_TRUE(read("v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n").mesh.colors.empty());
}

TEST(ObjReader, ABrokenVertexIsOneError) {
  const Result r = read("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  ASSERT_EQ(r.diagnostics.list().size(), 1u);
  EXPECT_EQ(first_error("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "1:3 the number is not finite or out of range");
}

TEST(ObjReader, FacesThatRunTheSameWayAreFoundAtTheirPlaces) {
  const Result turned = read(triangle_points + "v 1 1 0\nf 1 2 3\nf 2 3 4\n");
  const auto conflict = turned.mesh.first_conflict();
  ASSERT_TRUE(conflict);
  EXPECT_EQ(conflict->face, 1u);
  EXPECT_EQ(conflict->earlier_face, 0u);
  EXPECT_EQ(conflict->from, 1u);
  EXPECT_EQ(conflict->to, 2u);
  ASSERT_EQ(turned.mesh.face_places.size(), 2u);
  EXPECT_EQ((Location{turned.mesh.text, turned.mesh.face_places[1]}.line()), 6u);
  EXPECT_FALSE(read(triangle_points + "v 1 1 0\nf 1 2 3\nf 3 2 4\n").mesh.first_conflict());
}

TEST(ObjReader, AByteOrderMarkIsPassedOver) {
  const Result r = read("\xef\xbb\xbf" + triangle_points + "f 1 2 3\n");
  EXPECT_TRUE(r.diagnostics.list().empty());
  EXPECT_EQ(r.mesh.positions.size(), 3u);
}

TEST(ObjReader, BackslashJoinsLines) {
  const Result r = read("v 0 0 \\\n0\nv 1 0 0\nv 0 1 0\nf 1 2 \\\r\n 3\n");
  EXPECT_TRUE(r.diagnostics.list().empty());
  EXPECT_EQ(r.mesh.corner_positions, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(ObjReader, NamesComeFromGroupsElseMaterials) {
  const Result r =
      read(triangle_points + "usemtl bark\nf 1 2 3\ng tip of it \nf 1 2 3\ng\nf 1 2 3\ng tip of it\nf 1 2 3\n");
  EXPECT_EQ(r.mesh.names, (std::vector<std::string>{"bark", "tip of it"}));
  EXPECT_EQ(r.mesh.face_names, (std::vector<std::uint32_t>{0, 1, 0, 1}));
}

TEST(ObjReader, ErrorsPointToTheirPlace) {
  EXPECT_EQ(first_error(triangle_points + "f 1 2 4\n"), "4:7 there is no vertex 4; there are 3 so far");
  EXPECT_EQ(first_error(triangle_points + "f 1 2 0\n"), "4:7 there is no vertex 0; there are 3 so far");
  EXPECT_EQ(first_error(triangle_points + "f 1 2 -4\n"), "4:7 there is no vertex -4; there are 3 so far");
  EXPECT_EQ(first_error(triangle_points + "f 1 2 99999999999999999999\n"),
            "4:7 there is no vertex 99999999999999999999; there are 3 so far");
  EXPECT_EQ(first_error(triangle_points + "f 1/1 2 3\n"), "4:5 there is no texture coordinate 1; there are 0 so far");
  EXPECT_EQ(first_error(triangle_points + "f 1 2\n"), "4:2 a face needs at least 3 corners, found 2");
  EXPECT_EQ(first_error(triangle_points + "f 1 2 2\n"), "4:2 a face has vertex 2 twice");
  EXPECT_EQ(first_error(triangle_points + "f 1 2 x\n"), "4:7 expected the number of a vertex");
  EXPECT_EQ(first_error(triangle_points + "f 1 2.5 3\n"), "4:6 expected a blank between the corners of a face");
  EXPECT_EQ(first_error("v 1 2\n"), "1:6 expected a number");
  EXPECT_EQ(first_error("v 1 nan 2\n"), "1:5 the number is not finite or out of range");
  EXPECT_EQ(first_error("v 1 1e999 2\n"), "1:5 the number is not finite or out of range");
  EXPECT_EQ(first_error("v 1 -1e39 2\n"), "1:5 a coordinate is at most 1e+15");
  EXPECT_EQ(first_error("vt 1e16 2\n"), "1:4 a coordinate is at most 1e+15");
  EXPECT_EQ(first_error("v 1 2 3\n"), "1:1 the file holds no faces");
  EXPECT_EQ(first_error(""), "1:1 the file holds no faces");
}

TEST(ObjReader, StopsAfterTwentyErrors) {
  std::string text;
  for (int i = 0; i < 1000; ++i) text += "f 1 2 3\n";
  EXPECT_EQ(read(text).diagnostics.list().size(), 20u);
}

// Every index in range, every count consistent, whatever the bytes.
TEST(ObjReader, SurvivesDamagedFiles) {
  const std::string good = triangle_points + "vt 0 0\ng a\nf 1/1/1 2/1 3//1\nusemtl b\nf -1 -2 -3 \\\n\nf 1 2 3\n";
  const std::string_view alphabet = "0123456789 -/.\\\n\rfvtg#e\0x";
  for (Key k = 0; k < 5000; ++k) {
    std::string text = good.substr(0, 1 + hash_keys(k, 1) % good.size());
    for (int i = 0; i < 4; ++i)
      text[hash_keys(k, 2, Key(i)) % text.size()] = alphabet[hash_keys(k, 3, Key(i)) % alphabet.size()];
    const PolygonMesh mesh = read(text).mesh;
    ASSERT_EQ(mesh.face_starts.size(), mesh.face_count() + 1u);
    ASSERT_EQ(mesh.face_starts.back(), mesh.corner_positions.size());
    ASSERT_EQ(mesh.corner_uv.size(), mesh.corner_positions.size());
    for (std::uint32_t c : mesh.corner_positions) ASSERT_LT(c, mesh.positions.size());
    for (std::uint32_t c : mesh.corner_uv) ASSERT_TRUE(c == PolygonMesh::none || c < mesh.uv.size());
    for (std::uint32_t n : mesh.face_names) ASSERT_LT(n, mesh.names.size());
  }
}

TEST(ObjReader, LoadsFilesAndNamesTheOnesItCannot) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "meristem_obj_reader_test.obj";
  std::ofstream(path) << triangle_points << "f 1 2 3\n";
  Diagnostics diagnostics;
  EXPECT_EQ(load_mesh(path.string(), {}, diagnostics).face_count(), 1u);
  EXPECT_TRUE(diagnostics.list().empty());
  std::filesystem::remove(path);
  load_mesh(path.string(), {}, diagnostics);
  ASSERT_EQ(diagnostics.list().size(), 1u);
  EXPECT_EQ(diagnostics.list()[0].message, "cannot read \"" + path.string() + "\": No such file or directory");
}

}  // namespace
}  // namespace meristem
