#include "renderer/loading/load_part.h"

#include "geometry/fields/time.h"
#include "renderer/loading/step_counts.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

namespace meristem {

namespace {

Affine3d placement(Vec3d position, Vec3d rotate, Vec3d scale) {
  const Vec3d r = rotate * (pi / 180);
  return Affine3d::translation(position) * Affine3d::rotation({0, 1, 0}, r.y) * Affine3d::rotation({1, 0, 0}, r.x) *
         Affine3d::rotation({0, 0, 1}, r.z) * Affine3d::scaling(scale);
}

// Scale as one number or three, none of them zero.
Vec3d read_scale(Params& params) {
  const Value* scale =
      params.raw("scale", false,
                 R"({"anyOf": [{"type": ["number", "string"]}, )"
                 R"({"type": "array", "items": {"type": ["number", "string"]}, "minItems": 3, "maxItems": 3}], )"
                 R"("default": 1})",
                 "size: one number, or one along each axis; or expressions of time");
  Value storage;
  if (!scale || !(scale = params.now(*scale, 3, storage))) return Vec3d(1);
  Vec3d s(1);
  auto is_number = [](const Value& v) { return v.kind == Value::Kind::Number && v.number != 0; };
  if (is_number(*scale))
    s = Vec3d(scale->number);
  else if (scale->kind == Value::Kind::Array && scale->items.size() == 3 && is_number(scale->items[0]) &&
           is_number(scale->items[1]) && is_number(scale->items[2]))
    s = {scale->items[0].number, scale->items[1].number, scale->items[2].number};
  else
    params.error("scale", "\"scale\" is a number or [x, y, z], none of them 0");
  return s;
}

// The whole placement as three rows; nothing, with an error, if it is none that can be inverted.
std::optional<Affine3d> read_matrix(Params& params) {
  const Value* value = params.raw(
      "matrix", false, R"({"type": "array", "items": {"type": ["number", "string"]}, "minItems": 12, "maxItems": 12})",
      "the placement as the 3 rows of 4 numbers, or expressions of time, that take points into the world, "
      "instead of position, rotate and scale");
  Value storage;
  if (!value || !(value = params.now(*value, 1, storage))) return std::nullopt;
  std::array<double, 12> n{};
  bool good = value->kind == Value::Kind::Array && value->items.size() == n.size();
  for (std::size_t i = 0; good && i < n.size(); ++i) {
    good = value->items[i].kind == Value::Kind::Number && std::isfinite(value->items[i].number);
    n[i] = value->items[i].number;
  }
  const Affine3d m{{n[0], n[4], n[8]}, {n[1], n[5], n[9]}, {n[2], n[6], n[10]}, {n[3], n[7], n[11]}};
  if (!good || !(std::abs(m.determinant()) > 0))
    params.error("matrix", "\"matrix\" is 12 numbers, three rows of four, that can be inverted");
  else if (params.has("position") || params.has("rotate") || params.has("scale"))
    params.error("matrix", "an object has either a \"matrix\" or \"position\", \"rotate\" and \"scale\"");
  else
    return m;
  return std::nullopt;
}

}  // namespace

ObjectSection read_object(Params& params, const MaterialNames::Check& check_material) {
  params.allow_time();
  ObjectSection section;
  section.model = params.required_text("model", "name of one of the file's models");
  section.name = params.text("name", "", "in mattes; none: that of the model, numbered if it stands more than once");
  section.seed =
      params.integer("seed", 0, {0, 2147483647, ""}, "another seed grows another individual of the same kind");
  section.counts = read_step_counts(params);
  section.materials = MaterialNames::read(params, check_material);
  const Vec3d position = params.vector("position", {0, 0, 0}, any_range, "where the model's origin stands, in metres");
  const Vec3d rotate =
      params.vector("rotate", {0, 0, 0}, {-1e7, 1e7, "deg"}, "turns about x, y and z: first z, then x, then y");
  section.to_world = placement(position, rotate, read_scale(params));
  if (const std::optional<Affine3d> matrix = read_matrix(params)) section.to_world = *matrix;
  return section;
}

std::optional<Affine3d> object_transform(const Value& object, double time, Diagnostics& diagnostics) {
  TimeScope scope(time);
  Diagnostics found;
  Params params(object, "object", found);
  const ObjectSection section = read_object(params);
  return report_errors_at(time, found, diagnostics) ? std::nullopt : std::optional(section.to_world);
}

std::vector<std::string> object_names(const Value& objects) {
  std::vector<std::string> names;
  std::map<std::string, int> seen, total;
  const auto text = [](const Value& object, const char* key) {
    const Value* v = object.find(key);
    return v ? v->text : std::string();
  };
  for (const Value& o : objects.items) total[text(o, "model")] += text(o, "name").empty() ? 1 : 0;
  for (const Value& o : objects.items) {
    const std::string own = text(o, "name"), model = text(o, "model");
    names.push_back(!own.empty() ? own : total[model] == 1 ? model : fmt::format("{} {}", model, ++seen[model]));
  }
  return names;
}

ScatterSection read_scatter(Params& params) {
  ScatterSection section;
  section.models = params.raw(
      "scatter", true,
      R"({"type": "array", "minItems": 1, "items": {"type": "object", "properties": {"model": {"type": "string"}, )"
      R"("weight": {"type": "number", "exclusiveMinimum": 0, "default": 1}}, "required": ["model"], )"
      R"("additionalProperties": false}})",
      "the models to strew, each with a weight");
  section.on = params.required_text("on", "name of the model that makes the ground; it is not shown by this");
  section.levels = params.integer(
      "levels", 0, {0, 64, ""}, "levels of the ground's steps that decide where things stand; finer ones are ignored");
  section.settings = read_scatter_settings(params);
  return section;
}

GroupSection read_group(Params& params) {
  return {params.raw("group", true, R"({"type": "array", "items": {"$ref": "#/definitions/object"}})",
                     "objects, as in the scene's own list")};
}

std::vector<Placement> PartLibrary::place(const Value& objects) {
  std::vector<Placement> placements;
  if (objects.kind == Value::Kind::Array)
    for (const Value& object : objects.items) add_object(object, placements);
  else
    context_->diagnostics.error(objects.location,
                                fmt::format("a list of objects is an array, found {}", objects.kind_name()));
  return placements;
}

void PartLibrary::add_object(const Value& value, std::vector<Placement>& placements) {
  if (value.kind != Value::Kind::Object)
    return context_->diagnostics.error(
        value.location, fmt::format("an object is {{\"model\": name, ...}}, found {}", value.kind_name()));
  TimeScope opening(shutter_.opens);
  Diagnostics& diagnostics = context_->diagnostics;
  const std::size_t found_before = diagnostics.found();
  Params params(value, "object", diagnostics);
  const ObjectSection section = read_object(params, scene_.material_index);
  params.finish();
  const bool moves = opening.was_read() && shutter_.is_open() && diagnostics.found() == found_before;
  const auto made =
      part({section.model, section.seed, section.counts, section.materials.then(materials_)}, params, "model");
  if (!made) return;
  Placement placement{made->front(), section.to_world, 0, true};
  if (made->size() > 1) placement.moments = made;
  if (moves) placement.motion = motion_of(value, section.to_world);
  moves_ = moves_ || placement.moments || placement.motion;
  placements.push_back(std::move(placement));
}

std::shared_ptr<const Motion> PartLibrary::motion_of(const Value& object, const Affine3d& opening) {
  auto motion = std::make_shared<Motion>();
  motion->keys.push_back(opening);
  for (int key = 1; key < Shutter::keys; ++key) {
    const auto map = object_transform(object, shutter_.key_time(key), context_->diagnostics);
    if (!map) return nullptr;
    motion->keys.push_back(*map);
  }
  return motion;
}

void PartLibrary::check_unused() {
  if (!models_) return;
  for (const Member& m : models_->members)
    if (!used_.count(m.key)) build(m.key, m.value, 0);
}

std::shared_ptr<const PartMoments> PartLibrary::part(const Variant& variant, Params& params, const char* name) {
  const std::string& model = variant.model;
  const Value* value = models_ ? models_->find(model) : nullptr;
  if (!value) {
    if (params.has(name)) params.error(name, unknown_model(model));
    return nullptr;
  }
  used_.insert(model);
  const auto [known, is_new] = built_.try_emplace(variant);
  if (!is_new && known->second) return known->second;
  if (!under_construction_.insert(model).second) {
    params.error(name, fmt::format("model \"{}\" places itself", model));
    return nullptr;
  }
  auto made = is_new ? build_for_object(variant, *value, params) : nullptr;
  under_construction_.erase(model);
  return built_[variant] = std::move(made);
}

// All that is built meanwhile has the materials of the object.
std::shared_ptr<const PartMoments> PartLibrary::build_for_object(const Variant& variant, const Value& value,
                                                                 Params& params) {
  ModelContext context = *context_;
  context.material_index = [this, &variant](const std::string& name, const Location& where) {
    return scene_.material_index(variant.materials.of(name), where);
  };
  const ModelContext* const outer = std::exchange(context_, &context);
  MaterialNames outer_materials = std::exchange(materials_, variant.materials);
  auto made = build_moments(variant, value, params);
  materials_ = std::move(outer_materials);
  context_ = outer;
  return made;
}

std::shared_ptr<const PartMoments> PartLibrary::build_moments(const Variant& variant, const Value& value,
                                                              Params& params) {
  TimeScope first(shutter_.moment_time(0));
  PartMoments moments{build(variant, value, params)};
  if (!moments[0]) return nullptr;
  const ModelContext& usual = *context_;
  for (int m = 1; first.was_read() && shutter_.is_open() && m < shutter_.moments; ++m) {
    TimeScope scope(shutter_.moment_time(m));
    Diagnostics found;
    const ModelContext context{usual.material_index, usual.folder, found,
                               usual.cells,          usual.levels, usual.production_number};
    const ModelContext* const outer = std::exchange(context_, &context);
    moments.push_back(build(variant, value, params));
    context_ = outer;
    report_errors_at(shutter_.moment_time(m), found, usual.diagnostics);
    if (!moments.back()) return nullptr;
  }
  return std::make_shared<const PartMoments>(std::move(moments));
}

std::shared_ptr<const Part> PartLibrary::build(const Variant& variant, const Value& value, Params& params) {
  if (variant.counts.empty()) return build(variant.model, value, variant.seed);
  const auto changed = with_step_counts(value, variant.counts, params);
  return changed ? build(variant.model, *changed, variant.seed) : nullptr;
}

std::shared_ptr<const Part> PartLibrary::build(const std::string& name, const Value& value, int seed) {
  if (value.kind == Value::Kind::Object && value.find("scatter")) return build_scatter(name, value, seed);
  if (value.kind == Value::Kind::Object && value.find("group")) return build_group(value);
  auto model = build_model(name, value, seed, *context_);
  return model ? std::make_shared<const Part>(std::move(model)) : nullptr;
}

std::shared_ptr<const Part> PartLibrary::build_group(const Value& value) {
  Params params(value, "model \"group\"", context_->diagnostics);
  const GroupSection section = read_group(params);
  params.finish();
  if (!section.objects) return nullptr;
  std::vector<Placement> placements = place(*section.objects);
  return placements.empty() ? nullptr : std::make_shared<const Part>(std::move(placements));
}

std::shared_ptr<const Part> PartLibrary::build_scatter(const std::string& name, const Value& value, int seed) {
  Params params(value, "model \"scatter\"", context_->diagnostics);
  const ScatterSection section = read_scatter(params);
  params.finish();
  if (!section.models) return nullptr;
  auto choices = read_choices(*section.models, seed);
  const Value* ground_value = models_->find(section.on);
  if (!ground_value || !ground_value->find("base")) {
    if (params.has("on"))
      params.error("on", ground_value ? fmt::format("\"{}\" has no base mesh: it makes no ground", section.on)
                                      : unknown_model(section.on));
    return nullptr;
  }
  used_.insert(section.on);
  const auto ground = build_ground(section.on, *ground_value, section.levels, seed);
  if (!ground || choices.empty()) return nullptr;
  try {
    const Key salt = hash_keys(hash_text(name), Key(seed));
    return std::make_shared<const Part>(std::move(ground),
                                        std::make_shared<const Scatter>(section.settings, std::move(choices), salt));
  } catch (const std::runtime_error& error) {
    params.error("scale", error.what());
    return nullptr;
  }
}

std::shared_ptr<const Model> PartLibrary::build_ground(const std::string& on, const Value& value, int levels,
                                                       int seed) {
  const auto known = grounds_.find({on, levels, seed});
  if (known != grounds_.end()) return known->second;
  ModelContext context = *context_;
  context.cells = {.leaf_faces = 64, .keeps_leaf_meshes = true};
  context.levels = levels;
  std::shared_ptr<const Model> ground = build_model(on, value, seed, context);
  const TimeScope* const scope = TimeScope::current();
  const bool may_change = scope && scope->was_read();
  if (ground && !may_change) grounds_.emplace(std::tuple(on, levels, seed), ground);
  return ground;
}

std::vector<Scatter::Choice> PartLibrary::read_choices(const Value& list, int seed) {
  std::vector<Scatter::Choice> choices;
  if (list.items.empty())
    context_->diagnostics.error(
        list.location,
        fmt::format("\"scatter\" is an array of one or more {{\"model\": name}}, found {}", list.kind_name()));
  for (const Value& item : list.items) {
    Params params(item, "scattered model", context_->diagnostics);
    const std::string name = params.required_text("model", "name of one of the file's models");
    const double weight = params.real("weight", 1, {1e-9, 1e9, ""}, "how often, beside the others");
    params.finish();
    const auto made = part({name, seed, {}, materials_}, params, "model");
    if (!made) continue;
    moves_ = moves_ || made->size() > 1;
    choices.push_back({made->front(), weight, made->size() > 1 ? made : nullptr});
  }
  return choices;
}

std::string PartLibrary::unknown_model(const std::string& name) const {
  std::vector<std::string> names;
  if (models_)
    for (const Member& m : models_->members) names.push_back(m.key);
  const std::string_view near = nearest_name(name, names);
  return fmt::format("no model named \"{}\"{}; known: {}", name,
                     near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near), fmt::join(names, ", "));
}

}  // namespace meristem
