// Binary glTF 2.0: a mesh for each surface, a node for each place where it stands, a primitive for each material.
// Vertices are interleaved; colours (linear, 16 bits) are used where the material varies.
#include "renderer/image/atomic_file.h"
#include "renderer/interchange/mesh_writer.h"
#include "renderer/interchange/spool.h"
#include "renderer/language/json_writer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>

namespace meristem {
namespace {

// Numbers of the glTF 2.0 specification.
constexpr int float_type = 5126, unsigned_short_type = 5123, unsigned_int_type = 5125;
constexpr int array_buffer = 34962, element_array_buffer = 34963;
constexpr std::uint32_t file_magic = 0x46546C67, json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;

std::uint16_t unorm16(float x) { return std::uint16_t(std::lrint(std::clamp(x, 0.f, 1.f) * 65535)); }

std::string matrix_text(const Affine3d& m) {
  return fmt::format("[{},{},{},0,{},{},{},0,{},{},{},0,{},{},{},1]", m.x.x, m.x.y, m.x.z, m.y.x, m.y.y, m.y.z, m.z.x,
                     m.z.y, m.z.z, m.origin.x, m.origin.y, m.origin.z);
}

// A JSON array that grows.
class List {
 public:
  // Returns the index of the item.
  std::size_t add(const std::string& item) {
    if (count_ > 0) text_ += ',';
    text_ += item;
    return count_++;
  }
  std::string text() const { return "[" + text_ + "]"; }

 private:
  std::string text_;
  std::size_t count_ = 0;
};

class GlbWriter final : public MeshWriter {
 public:
  GlbWriter(const std::string& path, bool has_colors)
      : file_(path),
        folder_(std::filesystem::path(path).parent_path().string()),
        has_colors_(has_colors),
        stride_(has_colors ? 40 : 32),
        vertices_(folder_),
        indices_(folder_) {}

  void begin(const std::string& name, std::span<const Affine3d> places) override {
    end_surface();
    for (const Affine3d& place : places)
      nodes_.add(place.is_identity()
                     ? fmt::format(R"({{"mesh":{}}})", surfaces_.size())
                     : fmt::format(R"({{"mesh":{},"matrix":{}}})", surfaces_.size(), matrix_text(place)));
    surfaces_.push_back({name, vertices_.size(), 0, {}, {}});
  }

  void add(std::span<const MeshVertex> vertices, std::span<const MeshTriangle> triangles) override {
    Surface& surface = surfaces_.back();
    for (const MeshVertex& v : vertices) {
      add_vertex(v);
      surface.bounds.extend(v.position);
    }
    surface.vertices += vertices.size();
    for (const MeshTriangle& t : triangles)
      by_material_.try_emplace(t.material, folder_)
          .first->second.append_values(std::span<const std::uint32_t>(t.vertices));
    if (vertices_.size() + indices_.size() > most_bytes)
      throw TooMany("a .glb file has at most 4 GiB; PLY has no such limit");
  }

  void finish(std::span<const MaterialLook> materials, const MeshCamera& camera) override {
    end_surface();
    std::string json = json_text(materials, camera);
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::uint64_t binary_bytes = vertices_.size() + indices_.size();  // multiples of four
    const std::uint64_t total = 12 + 8 + json.size() + 8 + binary_bytes;
    if (total > most_bytes) throw TooMany("a .glb file has at most 4 GiB; PLY has no such limit");
    append_numbers({file_magic, 2, std::uint32_t(total), std::uint32_t(json.size()), json_chunk});
    file_.append(json);
    append_numbers({std::uint32_t(binary_bytes), binary_chunk});
    vertices_.copy_to(file_);
    indices_.copy_to(file_);
    file_.commit();
  }

 private:
  static constexpr std::uint64_t most_bytes = std::numeric_limits<std::uint32_t>::max();

  struct Primitive {
    std::uint32_t material;
    std::uint64_t first_byte, count;  // of the indices
  };
  struct Surface {
    std::string name;
    std::uint64_t first_byte, vertices;
    Bounds3f bounds;
    std::vector<Primitive> primitives;
  };

  void append_numbers(std::initializer_list<std::uint32_t> numbers) {
    for (const std::uint32_t n : numbers) file_.append({reinterpret_cast<const char*>(&n), sizeof n});
  }

  void add_vertex(const MeshVertex& v) {
    const float numbers[8] = {v.position.x, v.position.y, v.position.z, v.normal.x,
                              v.normal.y,   v.normal.z,   v.uv.x,       1 - v.uv.y};
    vertices_.append_values(std::span<const float>(numbers));
    if (!has_colors_) return;
    const std::uint16_t color[4] = {unorm16(v.color.x), unorm16(v.color.y), unorm16(v.color.z), 65535};
    vertices_.append_values(std::span<const std::uint16_t>(color));
  }

  void end_surface() {
    for (auto& [material, spool] : by_material_) {
      surfaces_.back().primitives.push_back({material, indices_.size(), spool.size() / sizeof(std::uint32_t)});
      spool.copy_to(indices_);
    }
    by_material_.clear();
  }

  static std::string camera_text(const MeshCamera& camera) {
    if (camera.height > 0)
      return fmt::format(R"({{"type":"orthographic","orthographic":{{"xmag":{},"ymag":{},"znear":0.01,"zfar":1e9}}}})",
                         camera.height * camera.aspect / 2, camera.height / 2);
    return fmt::format(R"({{"type":"perspective","perspective":{{"yfov":{},"aspectRatio":{},"znear":0.01}}}})",
                       camera.vertical_fov, camera.aspect);
  }

  std::string json_text(std::span<const MaterialLook> materials, const MeshCamera& camera) {
    List accessors, meshes;
    for (const Surface& s : surfaces_) meshes.add(mesh_text(s, materials, accessors));
    List material_list;
    for (const MaterialLook& m : materials) material_list.add(material_text(m));
    const std::size_t camera_node =
        nodes_.add(fmt::format(R"({{"camera":0,"matrix":{}}})", matrix_text(camera.to_world)));
    std::vector<std::size_t> roots(camera_node + 1);
    for (std::size_t i = 0; i < roots.size(); ++i) roots[i] = i;
    std::string views =
        fmt::format(R"({{"buffer":0,"byteOffset":0,"byteLength":{},"byteStride":{},"target":{}}},)"
                    R"({{"buffer":0,"byteOffset":{},"byteLength":{},"target":{}}})",
                    vertices_.size(), stride_, array_buffer, vertices_.size(), indices_.size(), element_array_buffer);
    std::string text = R"({"asset":{"version":"2.0","generator":"meristem"},)";
    text += R"("extensionsUsed":["KHR_materials_clearcoat","KHR_materials_ior","KHR_materials_transmission",)"
            R"("KHR_materials_emissive_strength"],)";
    text += fmt::format(R"("scene":0,"scenes":[{{"nodes":[{}]}}],"nodes":{},)", fmt::join(roots, ","), nodes_.text());
    text += fmt::format(R"("cameras":[{}],)", camera_text(camera));
    text += fmt::format(R"("materials":{})", material_list.text());
    if (surfaces_.empty()) return text + "}";
    return text + fmt::format(R"(,"meshes":{},"accessors":{},"bufferViews":[{}],"buffers":[{{"byteLength":{}}}]}})",
                              meshes.text(), accessors.text(), views, vertices_.size() + indices_.size());
  }

  std::string mesh_text(const Surface& s, std::span<const MaterialLook> materials, List& accessors) const {
    const auto add = [&](std::uint64_t offset, int type, const char* shape, const std::string& more = "") {
      return accessors.add(
          fmt::format(R"({{"bufferView":0,"byteOffset":{},"componentType":{},"count":{},"type":"{}"{}}})",
                      s.first_byte + offset, type, s.vertices, shape, more));
    };
    const Vec3f low = s.bounds.lower, high = s.bounds.upper;
    const std::size_t position =
        add(0, float_type, "VEC3",
            fmt::format(R"(,"min":[{},{},{}],"max":[{},{},{}])", low.x, low.y, low.z, high.x, high.y, high.z));
    const std::size_t normal = add(12, float_type, "VEC3"), uv = add(24, float_type, "VEC2");
    const std::size_t color = has_colors_ ? add(32, unsigned_short_type, "VEC4", R"(,"normalized":true)") : 0;
    List primitives;
    for (const Primitive& p : s.primitives) {
      const std::size_t indices = accessors.add(
          fmt::format(R"({{"bufferView":1,"byteOffset":{},"componentType":{},"count":{},"type":"SCALAR"}})",
                      p.first_byte, unsigned_int_type, p.count));
      const std::string colors = materials[p.material].varies ? fmt::format(R"(,"COLOR_0":{})", color) : "";
      primitives.add(fmt::format(R"({{"attributes":{{"POSITION":{},"NORMAL":{},"TEXCOORD_0":{}{}}},)"
                                 R"("indices":{},"material":{}}})",
                                 position, normal, uv, colors, indices, p.material));
    }
    return fmt::format(R"({{"name":{},"primitives":{}}})", json_quoted(s.name), primitives.text());
  }

  static std::string coat_text(const MaterialLook& m) {
    if (m.coat <= 0) return "";
    return fmt::format(R"("KHR_materials_clearcoat":{{"clearcoatFactor":{},"clearcoatRoughnessFactor":{}}},)", m.coat,
                       m.coat_roughness);
  }

  static std::string material_text(const MaterialLook& m) {
    const Spectrum c = m.varies ? Spectrum(1) : m.base_color;
    const float strength = std::max(max_component(m.emission), 0.f);
    const Spectrum glow = strength > 0 ? m.emission / strength : Spectrum{};
    return fmt::format(R"({{"name":{},"doubleSided":true{},"pbrMetallicRoughness":{{"baseColorFactor":[{},{},{},{}],)"
                       R"("metallicFactor":{},"roughnessFactor":{}}},"emissiveFactor":[{},{},{}],"extensions":{{)"
                       R"("KHR_materials_ior":{{"ior":{}}},"KHR_materials_transmission":{{"transmissionFactor":{}}},)"
                       R"({}"KHR_materials_emissive_strength":{{"emissiveStrength":{}}}}}}})",
                       json_quoted(m.name), m.opacity < 1 ? R"(,"alphaMode":"BLEND")" : "", c.x, c.y, c.z, m.opacity,
                       m.metalness, m.roughness, glow.x, glow.y, glow.z, m.ior, m.transmission, coat_text(m), strength);
  }

  AtomicFile file_;
  const std::string folder_;
  const bool has_colors_;
  const int stride_;
  Spool vertices_, indices_;
  std::map<std::uint32_t, Spool> by_material_;  // indices of the surface being written
  std::vector<Surface> surfaces_;
  List nodes_;
};

}  // namespace

std::unique_ptr<MeshWriter> make_glb_writer(const std::string& path, bool has_colors) {
  return std::make_unique<GlbWriter>(path, has_colors);
}

}  // namespace meristem
