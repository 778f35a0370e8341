#include "renderer/interchange/gltf_reader.h"

#include "renderer/interchange/foreign_mesh.h"
#include "renderer/interchange/gltf_materials.h"
#include "renderer/interchange/vertex_colors.h"
#include "renderer/language/json_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace meristem {

namespace {

constexpr std::size_t most_objects = 1'000'000;
constexpr int most_depth = 64;         // of nodes
constexpr double light_radius = 0.01;  // of a sphere that stands for a point

Affine3d rotation(double x, double y, double z, double w) {
  const double n = x * x + y * y + z * z + w * w, s = n > 0 ? 2 / n : 0;
  return {{1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)},
          {s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w)},
          {s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y)},
          {}};
}

class GltfReader {
 public:
  GltfReader(const std::string& path, AssetFolder& assets, Diagnostics& diagnostics)
      : buffers_(path, diagnostics), diagnostics_(diagnostics), materials_(buffers_, assets, diagnostics) {}

  ForeignScene read() {
    diagnostics_.throw_if_errors();
    warn_of_extensions();
    read_materials();
    const Value* scene = chosen_scene();
    const Value* roots = scene ? scene->find("nodes") : nullptr;
    for (const Value& node : roots ? roots->items : std::vector<Value>{}) read_node(node, {}, 0);
    if (buffers_.json().find("animations"))
      diagnostics_.warning(buffers_.json().find("animations")->location, "animations were left out");
    return std::move(scene_);
  }

 private:
  // The file's scene, or its first.
  const Value* chosen_scene() {
    const Value* index = buffers_.json().find("scene");
    if (index) return buffers_.item("scenes", index);
    const Value* scenes = buffers_.json().find("scenes");
    if (scenes && !scenes->items.empty()) return &scenes->items[0];
    diagnostics_.error(buffers_.json().location, "the file has no scene");
    return nullptr;
  }

  void warn_of_extensions() {
    static const std::set<std::string> known{
        "KHR_materials_ior",       "KHR_materials_transmission", "KHR_materials_emissive_strength",
        "KHR_materials_clearcoat", "KHR_lights_punctual",        "EXT_mesh_gpu_instancing"};
    const Value* required = buffers_.json().find("extensionsRequired");
    const Value* used = buffers_.json().find("extensionsUsed");
    for (const Value& e : required ? required->items : std::vector<Value>{})
      if (!known.count(e.text)) diagnostics_.error(e.location, fmt::format("the extension {} is not read", e.text));
    for (const Value& e : used ? used->items : std::vector<Value>{})
      if (!known.count(e.text)) diagnostics_.warning(e.location, fmt::format("the extension {} was left out", e.text));
  }

  void read_materials() {
    const Value* list = buffers_.json().find("materials");
    for (const Value& m : list ? list->items : std::vector<Value>{}) {
      const Value* name = m.find("name");
      add_material(name && !name->text.empty() ? name->text : "material", materials_.material(m));
    }
  }

  // Returns its name: the one that is wished, or one like it.
  std::string add_material(std::string name, Value material) {
    while (!material_names_.insert(name).second) name = fmt::format("{}-{}", name, material_names_.size());
    scene_.materials.push_back({name, {}, std::move(material)});
    return name;
  }

  void read_node(const Value& index, const Affine3d& parent, int depth) {
    const Value* node = is_stopped_ ? nullptr : buffers_.item("nodes", &index);
    if (!node) return;
    if (depth > most_depth || ++nodes_ > most_objects) {
      is_stopped_ = true;
      return diagnostics_.error(
          index.location, fmt::format("nodes nest deeper than {}, or are more than {}", most_depth, most_objects));
    }
    const Affine3d to_world = parent * transform_of(*node);
    if (const Value* mesh = node->find("mesh")) place_mesh(*mesh, *node, to_world);
    if (const Value* camera = node->find("camera")) add_camera(*camera, *node, to_world);
    if (const Value* all = node->find("extensions"))
      if (const Value* light = all->find("KHR_lights_punctual")) add_light(*light, to_world);
    if (const Value* children = node->find("children"))
      for (const Value& child : children->items) read_node(child, to_world, depth + 1);
  }

  static std::vector<double> numbers(const Value* value, std::vector<double> fallback) {
    if (!value || value->items.size() != fallback.size()) return fallback;
    for (std::size_t i = 0; i < fallback.size(); ++i) fallback[i] = value->items[i].number;
    return fallback;
  }

  Affine3d transform_of(const Value& node) {
    Affine3d m;
    if (const Value* matrix = node.find("matrix")) {
      const auto n = numbers(matrix, std::vector<double>(16, 0));
      m = {{n[0], n[1], n[2]}, {n[4], n[5], n[6]}, {n[8], n[9], n[10]}, {n[12], n[13], n[14]}};
    } else {
      m = placed(numbers(node.find("translation"), {0, 0, 0}), numbers(node.find("rotation"), {0, 0, 0, 1}),
                 numbers(node.find("scale"), {1, 1, 1}));
    }
    return m;
  }

  static Affine3d placed(const std::vector<double>& t, const std::vector<double>& r, const std::vector<double>& s) {
    return Affine3d::translation({t[0], t[1], t[2]}) * rotation(r[0], r[1], r[2], r[3]) *
           Affine3d::scaling({s[0], s[1], s[2]});
  }

  void place_mesh(const Value& index, const Value& node, const Affine3d& to_world) {
    const Value* mesh = buffers_.item("meshes", &index);
    if (!mesh) return;
    const std::vector<std::string>& models = models_of(*mesh);
    for (const Affine3d& instance : instances_of(node))
      for (const std::string& model : models) {
        const Affine3d m = to_world * instance;
        if (!(std::abs(m.determinant()) > 1e-30)) {
          diagnostics_.warning(index.location, "what is scaled to nothing was left out");
          continue;
        }
        is_stopped_ = scene_.objects.size() == most_objects;
        if (is_stopped_) return diagnostics_.error(index.location, fmt::format("more than {} objects", most_objects));
        scene_.objects.push_back({model, m});
      }
  }

  // One, or those of EXT_mesh_gpu_instancing.
  std::vector<Affine3d> instances_of(const Value& node) {
    const Value* all = node.find("extensions");
    const Value* instancing = all ? all->find("EXT_mesh_gpu_instancing") : nullptr;
    const Value* attributes = instancing ? instancing->find("attributes") : nullptr;
    if (!attributes) return {Affine3d{}};
    const auto read = [&](const char* name, int width) {
      const Value* index = attributes->find(name);
      return index ? buffers_.floats(index, width) : std::vector<float>{};
    };
    const std::vector<float> t = read("TRANSLATION", 3), r = read("ROTATION", 4), s = read("SCALE", 3);
    const std::size_t count = std::max({t.size() / 3, r.size() / 4, s.size() / 3});
    std::vector<Affine3d> instances;
    for (std::size_t i = 0; i < count; ++i) {
      const auto item = [&](const std::vector<float>& from, std::size_t width, std::vector<double> fallback) {
        for (std::size_t k = 0; k < width && from.size() >= (i + 1) * width; ++k)
          fallback[k] = double(from[i * width + k]);
        return fallback;
      };
      instances.push_back(placed(item(t, 3, {0, 0, 0}), item(r, 4, {0, 0, 0, 1}), item(s, 3, {1, 1, 1})));
    }
    return instances;
  }

  // A model for each primitive, made when the mesh is first placed.
  const std::vector<std::string>& models_of(const Value& mesh) {
    const auto [known, is_new] = models_.try_emplace(&mesh);
    if (!is_new) return known->second;
    const Value* name = mesh.find("name");
    const std::string base = file_name(name ? name->text : "");
    const Value* primitives = mesh.find("primitives");
    for (const Value& primitive : primitives ? primitives->items : std::vector<Value>{}) {
      ForeignModel model;
      model.name = fmt::format("{}-{}", base, scene_.models.size() + 1);
      if (const Value* material = primitive.find("material"); material && buffers_.item("materials", material))
        model.material = scene_.materials[std::size_t(material->number)].key;
      if (!read_primitive(primitive, model)) continue;
      known->second.push_back(model.name);
      scene_.models.push_back(std::move(model));
    }
    return known->second;
  }

  // Letters and digits of a name: it becomes that of a file.
  static std::string file_name(const std::string& name) {
    std::string result;
    for (const char c : name.substr(0, 64)) result += std::isalnum(static_cast<unsigned char>(c)) || c == '_' ? c : '-';
    return result.empty() ? "mesh" : result;
  }

  bool read_primitive(const Value& primitive, ForeignModel& model) {
    constexpr std::size_t triangles = 4;
    if (gltf_count(primitive, "mode", triangles) != triangles) {
      diagnostics_.warning(primitive.location, "a primitive that is no list of triangles was left out");
      return false;
    }
    const Value* attributes = primitive.find("attributes");
    const Value* position = attributes ? attributes->find("POSITION") : nullptr;
    if (!position) {
      diagnostics_.warning(primitive.location, "a primitive without positions was left out");
      return false;
    }
    ForeignMesh mesh;
    const std::vector<float> p = buffers_.floats(position, 3);
    for (std::size_t i = 0; i + 3 <= p.size(); i += 3) mesh.positions.push_back(Vec3d(Vec3f{p[i], p[i + 1], p[i + 2]}));
    if (const Value* normal = attributes->find("NORMAL")) {
      const std::vector<float> n = buffers_.floats(normal, 3);
      for (std::size_t i = 0; i + 3 <= n.size(); i += 3) mesh.normals.push_back({n[i], n[i + 1], n[i + 2]});
    }
    if (const Value* uv = attributes->find("TEXCOORD_0")) {
      const std::vector<float> t = buffers_.floats(uv, 2);
      for (std::size_t i = 0; i + 2 <= t.size(); i += 2) mesh.uv.push_back({double(t[i]), 1 - double(t[i + 1])});
    }
    if (mesh.normals.size() != mesh.positions.size()) mesh.normals.clear();
    if (mesh.uv.size() != mesh.positions.size()) mesh.uv.clear();
    read_triangles(primitive, mesh);
    const std::vector<Vec3f> colors = read_colors(attributes->find("COLOR_0"), mesh.positions.size());
    const bool vary = std::ranges::any_of(colors, [&](Vec3f c) { return c != colors[0]; });
    // A vertex has one pair of coordinates, which textures need
    const bool have_room = !vary || !has_textures(model.material);
    if (!have_room)
      diagnostics_.warning(attributes->find("COLOR_0")->location,
                           "colours of vertices were left out, since the material has textures");
    ColorPlane plane;
    if (vary && have_room) {
      plane = nearest_plane(colors);
      mesh.uv = plane.uv;
    }
    MeshRepairs repairs;
    model.mesh = to_polygon_mesh(mesh, repairs);
    repairs.report(primitive.location, diagnostics_);
    if (model.mesh->face_count() == 0) return false;
    if (vary && have_room)
      color_model(model, plane, attributes->find("COLOR_0")->location);
    else if (!vary && !colors.empty() && colors[0] != Vec3f(1))
      model.material = tinted(model.material, color_text(Vec3d(colors[0])));
    return true;
  }

  // Of the vertices, without opacity; empty if there are none.
  std::vector<Vec3f> read_colors(const Value* index, std::size_t vertices) {
    const Value* accessor = index ? buffers_.item("accessors", index) : nullptr;
    if (!accessor) return {};
    const Value* type = accessor->find("type");
    const std::size_t width = type && type->text == "VEC4" ? 4 : 3;
    const std::vector<float> c = buffers_.floats(index, int(width));
    if (c.size() != width * vertices) {
      if (!c.empty()) diagnostics_.warning(index->location, "colours that are not one a vertex were left out");
      return {};
    }
    std::vector<Vec3f> colors;
    bool is_opaque = true;
    for (std::size_t i = 0; i < c.size(); i += width) {
      colors.push_back({c[i], c[i + 1], c[i + 2]});
      is_opaque = is_opaque && (width == 3 || c[i + 3] == 1);
    }
    if (!is_opaque) diagnostics_.warning(index->location, "the opacity of vertices was left out");
    return colors;
  }

  const Value* find_material(const std::string& name) const {
    const auto known = std::ranges::find(scene_.materials, name, &Member::key);
    return known == scene_.materials.end() ? nullptr : &known->value;
  }
  bool has_textures(const std::string& material) const {
    const Value* known = find_material(material);
    return known && known->find("textures");
  }

  void color_model(ForeignModel& model, const ColorPlane& plane, const Location& where) {
    ColorsByUv colors = color_by_uv(*model.mesh, plane, where, diagnostics_);
    model.symbols = std::move(colors.symbols);
    model.material = tinted(model.material, fmt::format("({})", colors.expression));
  }

  // The name of a new material: a copy whose base colour is multiplied by an expression.
  std::string tinted(const std::string& name, const std::string& tint) {
    const Value* known = find_material(name);
    Value material = known ? *known : json::object({{"type", json::text("openpbr")}});
    const auto color = std::ranges::find(material.members, "base_color", &Member::key);
    if (color == material.members.end())
      material.members.push_back({"base_color", {}, json::text(tint)});
    else
      color->value.text = color->value.text == "[1, 1, 1]" ? tint : fmt::format("{}*{}", color->value.text, tint);
    return add_material(name.empty() ? "tinted" : name + "-tinted", std::move(material));
  }

  void read_triangles(const Value& primitive, ForeignMesh& mesh) {
    if (const Value* indices = primitive.find("indices")) {
      mesh.corners = buffers_.indices(indices, mesh.positions.size());
    } else {
      for (std::uint32_t i = 0; i < mesh.positions.size(); ++i) mesh.corners.push_back(i);
    }
    mesh.corners.resize(mesh.corners.size() / 3 * 3);
    for (std::uint32_t i = 3; i <= mesh.corners.size(); i += 3) mesh.face_starts.push_back(i);
  }

  void add_camera(const Value& index, const Value& node, const Affine3d& m) {
    const Value* camera = buffers_.item("cameras", &index);
    if (!camera) return;
    const Value* perspective = camera->find("perspective");
    const Value* parallel = camera->find("orthographic");
    if (!perspective && !parallel)
      return diagnostics_.warning(camera->location,
                                  "a camera that is neither perspective nor orthographic was left out");
    const Value* name = node.find("name");
    std::string unique = name && !name->text.empty() ? name->text : "camera";
    while (std::ranges::find(scene_.cameras, unique, &Member::key) != scene_.cameras.end())
      unique = fmt::format("{}-{}", unique, scene_.cameras.size());
    Value view =
        json::object({{"from", tidy_vector(m.origin)}, {"to", tidy_vector(m.origin - m.z)}, {"up", tidy_vector(m.y)}});
    double aspect = 16.0 / 9;
    if (perspective) {
      const double fov = std::clamp(gltf_number(perspective, "yfov", 0.7) * 180 / pi, 0.01, 170.0);
      view.members.push_back({"fov", {}, tidy_number(fov)});
      aspect = gltf_number(perspective, "aspectRatio", aspect);
    } else {
      const double half_height = gltf_number(parallel, "ymag", 1), half_width = gltf_number(parallel, "xmag", 1);
      const double height = std::clamp(2 * std::abs(half_height) * length(m.y), 1e-9, 1e9);
      view.members.insert(view.members.begin(), {"type", {}, json::text("orthographic")});
      view.members.push_back({"height", {}, tidy_number(height)});
      aspect = std::abs(half_width / half_height);
    }
    scene_.cameras.push_back({unique, {}, std::move(view)});
    if (scene_.render.empty() && aspect > 0.01 && aspect < 100)
      scene_.render =
          json::object({{"size", json::array({json::number(std::round(720 * aspect)), json::number(720)})}}).members;
  }

  void add_light(const Value& reference, const Affine3d& m) {
    const Value* all = buffers_.json().find("extensions");
    const Value* extension = all ? all->find("KHR_lights_punctual") : nullptr;
    const Value* lights = extension ? extension->find("lights") : nullptr;
    const std::size_t index = gltf_count(reference, "light", ~std::size_t(0));
    if (!lights || index >= lights->items.size())
      return diagnostics_.error(reference.location, "there is no such light");
    const Value& light = lights->items[index];
    const Value* type = light.find("type");
    const auto c = numbers(light.find("color"), {1, 1, 1});
    const Vec3d intensity = Vec3d{c[0], c[1], c[2]} * gltf_number(&light, "intensity", 1);
    if (type && type->text == "directional") {
      scene_.lights.push_back(json::object({{"type", json::text("distant")},
                                            {"direction", tidy_vector(-m.z)},
                                            {"irradiance", tidy_vector(intensity)},
                                            {"angle", json::number(0)}}));
    } else if (type && type->text == "point") {
      scene_.lights.push_back(json::object({{"type", json::text("sphere")},
                                            {"center", tidy_vector(m.origin)},
                                            {"radius", json::number(light_radius)},
                                            {"color", tidy_vector(intensity / (pi * light_radius * light_radius))},
                                            {"intensity", json::number(1)}}));
      diagnostics_.warning(light.location, fmt::format("a point became a glowing ball of radius {}", light_radius));
    } else {
      diagnostics_.warning(light.location, "a light that is neither directional nor a point was left out");
    }
  }

  GltfBuffers buffers_;
  Diagnostics& diagnostics_;
  GltfMaterials materials_;
  ForeignScene scene_;
  std::set<std::string> material_names_;
  std::map<const Value*, std::vector<std::string>> models_;
  std::size_t nodes_ = 0;
  bool is_stopped_ = false;  // at a limit
};

}  // namespace

ForeignScene read_gltf(const std::string& path, AssetFolder& assets, Diagnostics& diagnostics) {
  ForeignScene scene = GltfReader(path, assets, diagnostics).read();
  diagnostics.throw_if_errors();
  return scene;
}

}  // namespace meristem
