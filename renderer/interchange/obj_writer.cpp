// Wavefront OBJ: positions, normals, u and v, triangles by material; the materials in an .mtl file beside it.
#include "renderer/image/atomic_file.h"
#include "renderer/interchange/flattening.h"

#include <fmt/format.h>

#include <cctype>
#include <filesystem>
#include <iterator>

namespace meristem {
namespace {

// Numbers as short as they can be and still read back the same.
class ObjWriter final : public MeshWriter {
 public:
  ObjWriter(const std::string& path, const std::vector<std::string>& material_names)
      : file_(path),
        names_(material_names),
        material_path_(std::filesystem::path(path).replace_extension(".mtl").string()) {
    check_writable(material_path_);
    text_ = fmt::format("# made by meristem; y is up\nmtllib {}\n",
                        std::filesystem::path(material_path_).filename().string());
  }

  void begin(const std::string& name, std::span<const Affine3d> places) override {
    flattening_.begin(places, vertex_count_);
    text_ += fmt::format("o {}\n", name);
    material_ = -1;
  }

  void add(std::span<const MeshVertex> vertices, std::span<const MeshTriangle> triangles) override {
    flattening_.add_block(vertices.size());
    vertex_count_ += vertices.size() * flattening_.places().size();
    for (std::size_t i = 0; i < flattening_.places().size(); ++i) {
      const Flattening::Place& place = flattening_.places()[i];
      for (const MeshVertex& vertex : vertices) {
        const MeshVertex v = place.apply(vertex);
        fmt::format_to(std::back_inserter(text_), "v {} {} {}\nvt {} {}\nvn {} {} {}\n", v.position.x, v.position.y,
                       v.position.z, v.uv.x, v.uv.y, v.normal.x, v.normal.y, v.normal.z);
      }
      for (const MeshTriangle& t : triangles) {
        if (material_ != int(t.material)) {
          material_ = int(t.material);
          text_ += fmt::format("usemtl {}\n", material_name(t.material));
        }
        std::array<std::uint64_t, 3> n;
        const std::array<std::uint32_t, 3> corners = place.corners(t);
        for (std::size_t k = 0; k < 3; ++k) n[k] = flattening_.number(corners[k], i) + 1;
        fmt::format_to(std::back_inserter(text_), "f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}\n", n[0], n[1], n[2]);
      }
      flush();
    }
  }

  void finish(std::span<const MaterialLook> materials, const MeshCamera&) override {
    std::string text = "# made by meristem\n";
    for (std::size_t i = 0; i < materials.size(); ++i)
      if (materials[i].is_used) text += material_text(i, materials[i]);
    write_file(material_path_, text);
    file_.append(text_);
    file_.commit();
  }

 private:
  // Names may hold blanks, so what is no letter or digit is left out, and a number keeps them apart.
  std::string material_name(std::size_t index) const {
    std::string name;
    for (const char c : names_[index])
      if (std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-') name += c;
    return name == names_[index] ? name : fmt::format("{}.{}", name, index);
  }

  std::string material_text(std::size_t index, const MaterialLook& m) const {
    const Spectrum diffuse = m.base_color * ((1 - m.metalness) * (1 - m.transmission));
    const float f0 = (m.ior - 1) * (m.ior - 1) / ((m.ior + 1) * (m.ior + 1));
    const Spectrum specular = m.base_color * m.metalness + Spectrum(f0) * (1 - m.metalness);
    const float alpha = std::max(m.roughness * m.roughness, 1e-3f);
    std::string text = fmt::format("\nnewmtl {}\nillum {}\n", material_name(index), m.transmission > 0.5f ? 7 : 2);
    text +=
        fmt::format("Kd {} {} {}\nKs {} {} {}\n", diffuse.x, diffuse.y, diffuse.z, specular.x, specular.y, specular.z);
    text += fmt::format("Ke {} {} {}\n", m.emission.x, m.emission.y, m.emission.z);
    text += fmt::format("Ns {}\nNi {}\nd {}\n", std::min(2 / (alpha * alpha) - 2, 1000.f), m.ior, m.opacity);
    return text + fmt::format("Pm {}\nPr {}\n", m.metalness, m.roughness);
  }

  void flush() {
    constexpr std::size_t block_bytes = std::size_t(1) << 18;
    if (text_.size() < block_bytes) return;
    file_.append(text_);
    text_.clear();
  }

  AtomicFile file_;
  const std::vector<std::string> names_;  // of the materials
  const std::string material_path_;
  std::string text_;
  Flattening flattening_;
  std::uint64_t vertex_count_ = 0;
  int material_ = -1;
};

}  // namespace

std::unique_ptr<MeshWriter> make_obj_writer(const std::string& path, const std::vector<std::string>& material_names) {
  return std::make_unique<ObjWriter>(path, material_names);
}

}  // namespace meristem
