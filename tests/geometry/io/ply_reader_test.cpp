#include "geometry/io/ply_reader.h"

#include "geometry/base/key.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

namespace meristem {
namespace {

struct Result {
  PolygonMesh mesh;
  Diagnostics diagnostics;
};

Result read(const std::string& text) {
  Result r;
  r.mesh = read_ply(std::make_shared<SourceText>(SourceText{"test.ply", text}), r.diagnostics);
  return r;
}

// The first error as "line:column message".
std::string first_error(const std::string& text) {
  const Result r = read(text);
  if (r.diagnostics.list().empty()) return {};
  const Diagnostic& d = r.diagnostics.list().front();
  return std::to_string(d.location.line()) + ":" + std::to_string(d.location.column()) + " " + d.message;
}

const std::string triangle_header =
    "ply\nformat ascii 1.0\ncomment a triangle\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";

TEST(PlyReader, ReadsTextWithCoordinatesAndWhatItDoesNotKnow) {
  const Result r = read(
      "ply\r\nformat ascii 1.0\r\nobj_info x\nelement vertex 4\nproperty double x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty float s\nproperty float t\nelement face 2\n"
      "property list uchar uint vertex_index\nproperty int flags\nelement edge 1\nproperty int vertex1\n"
      "property list uchar float weights\nend_header\n"
      "0 0 0 255 0 0\n1.5 0 -2e1 0 1 0\n1 1 0 0 1 1\n0 1 0 0 0 1\n3 0 1 2 7\n4 0 1 2 3 7\n5 2 0.5 0.5\n");
  EXPECT_TRUE(r.diagnostics.list().empty());
  ASSERT_EQ(r.mesh.positions.size(), 4u);
  EXPECT_EQ(r.mesh.positions[1], (Vec3d{1.5, 0, -20}));
  EXPECT_EQ(r.mesh.uv[2], (Vec2d{1, 1}));
  EXPECT_EQ(r.mesh.face_starts, (std::vector<std::uint32_t>{0, 3, 7}));
  EXPECT_EQ(r.mesh.corner_positions, (std::vector<std::uint32_t>{0, 1, 2, 0, 1, 2, 3}));
  EXPECT_EQ(r.mesh.corner_uv, r.mesh.corner_positions);
}

TEST(PlyReader, ReadsColorsOfVertices) {
  const auto colored = [](const std::string& type) {
    std::string text = triangle_header;
    text.replace(text.find("element face"), 12,
                 "property " + type + " red\nproperty " + type + " green\nproperty " + type + " blue\nproperty " +
                     type + " alpha\nelement face");
    return text;
  };
  const Result bytes = read(colored("uchar") + "0 0 0 255 0 128 255  1 0 0 0 0 0 255  0 1 0 0 0 0 255  3 0 1 2\n");
  EXPECT_TRUE(bytes.diagnostics.list().empty());
  ASSERT_EQ(bytes.mesh.colors.size(), 3u);
  EXPECT_EQ(bytes.mesh.colors[0].x, 1);
  EXPECT_NEAR(bytes.mesh.colors[0].z, 0.2158, 1e-3) << "sRGB";
  const Result floats = read(colored("float") + "0 0 0 1 0 .5 1  1 0 0 0 0 0 1  0 1 0 0 0 0 1  3 0 1 2\n");
  EXPECT_EQ(floats.mesh.colors.at(0), (Vec3f{1, 0, .5f})) << "linear";
  EXPECT_TRUE(read(triangle_header + "0 0 0  1 0 0  0 1 0\n3 0 1 2\n").mesh.colors.empty());
}

TEST(PlyReader, CornersMayHaveCoordinatesOfTheirOwn) {
  std::string text = triangle_header;
  text.replace(text.find("end_header"), 10, "property list uchar float texcoord\nend_header");
  const Result r = read(text + "0 0 0 1 0 0 0 1 0  3 0 1 2  6 0 0 .5 0 0 .5\n");
  EXPECT_TRUE(r.diagnostics.list().empty());
  ASSERT_EQ(r.mesh.uv.size(), 3u);
  EXPECT_EQ(r.mesh.uv[r.mesh.corner_uv[1]], (Vec2d{.5, 0}));
}

// A tetrahedron in binary, each number in the given byte order.
std::string binary_tetrahedron(bool big_endian) {
  std::string text = std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
                     "_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty double z\n"
                     "element face 4\nproperty ushort group\nproperty list uchar int vertex_indices\nend_header\n";
  const auto append = [&](auto value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    if (big_endian) std::reverse(bytes, bytes + sizeof value);
    text.append(bytes, sizeof value);
  };
  const float points[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const auto& p : points) append(p[0]), append(p[1]), append(double(p[2]));
  const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  for (const auto& f : faces) {
    append(std::uint16_t(7)), append(std::uint8_t(3));
    for (const int v : f) append(v);
  }
  return text;
}

TEST(PlyReader, ReadsBothByteOrders) {
  for (const bool big_endian : {false, true}) {
    const Result r = read(binary_tetrahedron(big_endian));
    EXPECT_TRUE(r.diagnostics.list().empty());
    ASSERT_EQ(r.mesh.face_count(), 4u);
    EXPECT_EQ(r.mesh.positions[3], (Vec3d{0, 0, 1}));
    EXPECT_EQ(r.mesh.corner_positions[8], 3u);
  }
}

TEST(PlyReader, ErrorsSayWhereAndWhatWouldBeRight) {
  EXPECT_EQ(first_error("solid x\n"), "1:1 a PLY file begins with the line \"ply\"");
  EXPECT_EQ(first_error("ply\nformat text 1.0\n"),
            "2:1 expected \"format ascii 1.0\", binary_little_endian or binary_big_endian");
  EXPECT_EQ(first_error(triangle_header + "0 0 0  1 0 0  0 1 x\n"), "11:19 expected a number");
  EXPECT_EQ(first_error(triangle_header + "0 0 0  1 0 0  0 1 nan\n3 0 1 2\n"), "11:22 a number is not finite");
  EXPECT_EQ(first_error(triangle_header + "0 0 0  1 0 0  0 1 1e39\n3 0 1 2\n"), "11:23 a number is larger than 1e+15");
  EXPECT_EQ(first_error(triangle_header + "0 0 0  1 0 0  0 1 0\n3 0 1 3\n"),
            "12:8 there is no vertex 3; there are 3, from 0 on");
  EXPECT_EQ(first_error(triangle_header + "0 0 0  1 0 0  0 1 0\n3 0 1 1\n"), "12:8 a face has vertex 2 twice");
  EXPECT_EQ(first_error(triangle_header + "0 0 0  1 0 0  0 1 0\n2 0 1\n"),
            "12:6 a face needs at least 3 corners, found 2");
  EXPECT_EQ(first_error(triangle_header + "0 0 0  1 0 0  0 1 0\n200 0 1\n"),
            "12:4 a list of 200 numbers does not fit into the file");
  EXPECT_EQ(first_error(triangle_header + "0 0 0  1 0 0  0 1 0\n3 0 1\n"), "13:1 the file ends here");
  std::string huge = triangle_header;
  huge.replace(huge.find("vertex 3"), 8, "vertex 4000000000");
  EXPECT_EQ(first_error(huge), "4:1 4000000000 of these do not fit into the file's 182 bytes");
  std::string nothing = triangle_header;
  nothing.replace(nothing.find("element face"), 0, "element point 99999999999\n");
  EXPECT_EQ(first_error(nothing + "0 0 0  1 0 0  0 1 0\n3 0 1 2\n"), "8:1 \"point\" has no properties");
  std::string binary = binary_tetrahedron(false);
  binary[binary.size() - 1] = 1;  // the high byte of an index
  EXPECT_EQ(first_error(binary), "7:1 in face 3: there is no vertex 16777218; there are 4, from 0 on");
}

// Every truncation, and many spoilt bytes: an error or a mesh whose indices hold, never a crash.
TEST(PlyReader, BrokenFilesAreErrors) {
  const auto check = [](const std::string& text, bool must_fail) {
    const Result r = read(text);
    EXPECT_TRUE(r.diagnostics.has_errors() || !must_fail);
    if (r.diagnostics.has_errors()) return;
    for (const std::uint32_t v : r.mesh.corner_positions) ASSERT_LT(v, r.mesh.positions.size());
    for (const std::uint32_t uv : r.mesh.corner_uv) ASSERT_TRUE(uv == PolygonMesh::none || uv < r.mesh.uv.size());
    for (const Vec3d p : r.mesh.positions) ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
  };
  const std::string texts[] = {triangle_header + "0 0 0  1 0 0  0 1 0\n3 0 1 2", binary_tetrahedron(false),
                               binary_tetrahedron(true)};
  for (const std::string& text : texts) {
    for (std::size_t size = 0; size < text.size(); ++size) check(text.substr(0, size), true);
    for (Key i = 0; i < 4000; ++i) {
      std::string spoilt = text;
      for (Key k = 0; k < 1 + i % 3; ++k) spoilt[hash_keys(i, k, 1) % spoilt.size()] = char(hash_keys(i, k, 2));
      check(spoilt, false);
    }
  }
}

}  // namespace
}  // namespace meristem
