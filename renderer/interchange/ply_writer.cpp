// Binary PLY in the byte order of most machines: positions, normals, u and v as s and t, colours (sRGB) if there are,
// triangles with the index of their material, whose names are comments.
#include "renderer/interchange/flattening.h"
#include "renderer/interchange/spool.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <limits>

namespace meristem {
namespace {

static_assert(std::endian::native == std::endian::little);

std::uint8_t srgb_byte(float linear) {
  const float x = std::clamp(linear, 0.f, 1.f);
  return std::uint8_t(std::lrint(255 * (x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f)));
}

class PlyWriter final : public MeshWriter {
 public:
  PlyWriter(const std::string& path, bool has_colors)
      : file_(path),
        has_colors_(has_colors),
        vertices_(std::filesystem::path(path).parent_path().string()),
        faces_(std::filesystem::path(path).parent_path().string()) {}

  void begin(const std::string&, std::span<const Affine3d> places) override {
    flattening_.begin(places, vertex_count_);
  }

  void add(std::span<const MeshVertex> vertices, std::span<const MeshTriangle> triangles) override {
    flattening_.add_block(vertices.size());
    vertex_count_ += vertices.size() * flattening_.places().size();
    if (vertex_count_ > std::numeric_limits<std::uint32_t>::max())
      throw TooMany("a PLY file has at most 2^32 vertices");
    for (std::size_t i = 0; i < flattening_.places().size(); ++i) {
      const Flattening::Place& place = flattening_.places()[i];
      for (const MeshVertex& v : vertices) add_vertex(place.apply(v));
      for (const MeshTriangle& t : triangles) {
        std::array<std::uint32_t, 3> corners = place.corners(t);
        for (std::uint32_t& c : corners) c = std::uint32_t(flattening_.number(c, i));
        add_face(corners, std::uint16_t(t.material));
      }
    }
  }

  void finish(std::span<const MaterialLook> materials, const MeshCamera&) override {
    file_.append(header(materials));
    vertices_.copy_to(file_);
    faces_.copy_to(file_);
    file_.commit();
  }

 private:
  void add_vertex(const MeshVertex& v) {
    const float numbers[8] = {v.position.x, v.position.y, v.position.z, v.normal.x,
                              v.normal.y,   v.normal.z,   v.uv.x,       v.uv.y};
    vertices_.append_values(std::span<const float>(numbers));
    if (!has_colors_) return;
    const std::uint8_t color[3] = {srgb_byte(v.color.x), srgb_byte(v.color.y), srgb_byte(v.color.z)};
    vertices_.append_values(std::span<const std::uint8_t>(color));
  }

  void add_face(const std::array<std::uint32_t, 3>& corners, std::uint16_t material) {
    const std::uint8_t count = 3;
    faces_.append_values(std::span<const std::uint8_t>(&count, 1));
    faces_.append_values(std::span<const std::uint32_t>(corners));
    faces_.append_values(std::span<const std::uint16_t>(&material, 1));
    ++face_count_;
  }

  std::string header(std::span<const MaterialLook> materials) const {
    std::string text = "ply\nformat binary_little_endian 1.0\ncomment made by meristem; y is up\n";
    for (std::size_t i = 0; i < materials.size(); ++i)
      if (materials[i].is_used) text += fmt::format("comment material {} {}\n", i, materials[i].name);
    text += fmt::format("element vertex {}\n", vertex_count_);
    for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "s", "t"})
      text += fmt::format("property float {}\n", name);
    for (const char* name : {"red", "green", "blue"})
      if (has_colors_) text += fmt::format("property uchar {}\n", name);
    text += fmt::format("element face {}\nproperty list uchar uint vertex_indices\n", face_count_);
    return text + "property ushort material_index\nend_header\n";
  }

  AtomicFile file_;
  const bool has_colors_;
  Spool vertices_, faces_;
  Flattening flattening_;
  std::uint64_t vertex_count_ = 0, face_count_ = 0;
};

}  // namespace

std::unique_ptr<MeshWriter> make_ply_writer(const std::string& path, bool has_colors) {
  return std::make_unique<PlyWriter>(path, has_colors);
}

}  // namespace meristem
