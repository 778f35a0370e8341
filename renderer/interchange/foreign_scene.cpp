#include "renderer/interchange/foreign_scene.h"

#include "geometry/io/whole_file.h"
#include "renderer/image/atomic_file.h"
#include "renderer/language/json_value.h"
#include "renderer/language/json_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>

namespace meristem {

namespace fs = std::filesystem;

namespace {

std::string obj_text(const PolygonMesh& mesh) {
  std::string text = "# made by meristem convert\n";
  const auto out = std::back_inserter(text);
  for (const Vec3d& p : mesh.positions) fmt::format_to(out, "v {} {} {}\n", p.x, p.y, p.z);
  for (const Vec2d& uv : mesh.uv) fmt::format_to(out, "vt {} {}\n", uv.x, uv.y);
  std::string_view group;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    if (const std::string& name = mesh.names[mesh.face_names[f]]; name != group) {
      fmt::format_to(out, "g {}\n", name);
      group = name;
    }
    text += 'f';
    for (std::uint32_t c = mesh.face_starts[f]; c < mesh.face_starts[f + 1]; ++c)
      if (mesh.corner_uv[c] == PolygonMesh::none)
        fmt::format_to(out, " {}", mesh.corner_positions[c] + 1);
      else
        fmt::format_to(out, " {}/{}", mesh.corner_positions[c] + 1, mesh.corner_uv[c] + 1);
    text += '\n';
  }
  return text;
}

Value object_value(const ForeignObject& object) {
  Value value = json::object({{"model", json::text(object.model)}});
  if (object.to_parent.is_identity()) return value;
  const Affine3d& m = object.to_parent;
  std::vector<Value> numbers;
  for (int row = 0; row < 3; ++row)
    for (const Vec3d& column : {m.x, m.y, m.z, m.origin}) numbers.push_back(tidy_number(column[row]));
  value.members.push_back({"matrix", {}, json::array(std::move(numbers))});
  return value;
}

Value object_list(const std::vector<ForeignObject>& objects) {
  std::vector<Value> values;
  for (const ForeignObject& o : objects) values.push_back(object_value(o));
  return json::array(std::move(values));
}

Value members(std::vector<Member> list) {
  Value value = json::object({});
  value.members = std::move(list);
  return value;
}

Value model_value(const ForeignModel& model, AssetFolder& assets) {
  Value value = json::object({{"base", model.base}});
  if (model.mesh)
    value.members[0].value = json::object(
        {{"type", json::text("mesh")}, {"file", json::text(assets.write(model.name + ".obj", obj_text(*model.mesh)))}});
  if (!model.symbols.empty()) {
    Value symbols = json::object({});
    for (const auto& [name, symbol] : model.symbols) symbols.members.push_back({name, {}, json::text(symbol)});
    value.members[0].value.members.push_back({"symbols", {}, std::move(symbols)});
  }
  if (!model.material.empty()) value.members.push_back({"material", {}, json::text(model.material)});
  if (!model.steps.empty()) value.members.push_back({"steps", {}, json::array(model.steps)});
  return value;
}

// By the names of models and groups, in their own frames.
std::map<std::string, Bounds3d> bounds_by_name(const ForeignScene& scene) {
  std::map<std::string, Bounds3d> bounds;
  for (const ForeignModel& model : scene.models) {
    Bounds3d& b = bounds[model.name];
    if (model.mesh)
      for (const Vec3d& p : model.mesh->positions) b.extend(p);
    else
      b = {Vec3d(-0.5), Vec3d(0.5)};  // the bases that importers use
  }
  for (const auto& [name, objects] : scene.groups) {
    Bounds3d b;
    for (const ForeignObject& o : objects) b.extend(o.to_parent.bounds(bounds[o.model]));
    bounds[name] = b;
  }
  return bounds;
}

Value framing_camera(const Bounds3d& bounds) {
  const Vec3d center = (bounds.lower + bounds.upper) * 0.5;
  const double distance = std::max(1.5 * length(bounds.upper - bounds.lower), 1e-3);
  return json::object(
      {{"from", tidy_vector(center + normalize(Vec3d{0.6, 0.4, 1}) * distance)}, {"to", tidy_vector(center)}});
}

}  // namespace

Value tidy_number(double x) { return json::number(std::stod(fmt::format("{:.12g}", x)) + 0.0); }
Value tidy_vector(Vec3d v) { return json::array({tidy_number(v.x), tidy_number(v.y), tidy_number(v.z)}); }

AssetFolder::AssetFolder(const std::string& scene_path)
    : folder_(fs::path(scene_path).parent_path().string()), name_(fs::path(scene_path).stem().string() + "-files") {}

std::string AssetFolder::path_of(const std::string& name) {
  const fs::path folder = fs::path(folder_) / name_;
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) throw FileError(fmt::format("cannot make the folder {}: {}", folder.string(), code.message()));
  return (folder / name).string();
}

std::string AssetFolder::write(const std::string& name, std::string_view bytes) {
  write_file(path_of(name), bytes);
  return name_ + "/" + name;
}

std::string AssetFolder::copy(const std::string& path, const Location& where, Diagnostics& diagnostics) {
  for (const auto& [from, name] : copied_)
    if (from == path) return name;
  std::string reason;
  const std::optional<std::string> bytes = read_whole_file(path, reason);
  if (!bytes) {
    diagnostics.error(where, std::move(reason));
    return {};
  }
  const std::string base = fs::path(path).filename().string();
  const auto is_taken = [&](const std::string& name) {
    return std::ranges::any_of(copied_, [&](const auto& c) { return c.second == name_ + "/" + name; });
  };
  std::string name = base;
  for (int i = 2; is_taken(name); ++i) name = fmt::format("{}-{}", i, base);
  copied_.emplace_back(path, write(name, *bytes));
  return copied_.back().second;
}

void complete_foreign_scene(ForeignScene& scene, Diagnostics& diagnostics) {
  if (scene.cameras.empty()) {
    auto bounds = bounds_by_name(scene);
    Bounds3d all;
    for (const ForeignObject& o : scene.objects) all.extend(o.to_parent.bounds(bounds[o.model]));
    scene.cameras.push_back({"camera", {}, all.empty() ? json::object({}) : framing_camera(all)});
    diagnostics.warning({}, "there is no camera that is understood: one was added that sees everything");
  }
  const bool glows =
      std::ranges::any_of(scene.materials, [](const Member& m) { return m.value.find("emission_color"); });
  if (!scene.lights.empty() || glows) return;
  scene.lights.push_back(json::object({{"type", json::text("constant")}}));
  diagnostics.warning({}, "there is no light that is understood: an even one was added");
}

void write_foreign_scene(const ForeignScene& scene, const std::string& path, AssetFolder& assets) {
  std::vector<Member> models;
  for (const ForeignModel& m : scene.models) models.push_back({m.name, {}, model_value(m, assets)});
  for (const auto& [name, objects] : scene.groups)
    models.push_back({name, {}, json::object({{"group", object_list(objects)}})});
  const Value file = json::object({{"format", json::number(1)},
                                   {"materials", members(scene.materials)},
                                   {"models", members(std::move(models))},
                                   {"objects", object_list(scene.objects)},
                                   {"lights", json::array(scene.lights)},
                                   {"cameras", members(scene.cameras)},
                                   {"render", members(scene.render)}});
  write_file(path, to_json(file) + "\n");
}

std::string path_inside(const std::string& folder, const std::string& file) {
  std::error_code code;
  const fs::path root = fs::weakly_canonical(folder.empty() ? "." : folder, code);
  const fs::path path = fs::weakly_canonical(root / file, code);
  const auto [end, rest] = std::mismatch(root.begin(), root.end(), path.begin(), path.end());
  return !code && end == root.end() && fs::path(file).is_relative() ? path.string() : std::string();
}

}  // namespace meristem
