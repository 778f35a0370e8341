#include "renderer/loading/load_world.h"

#include <fmt/format.h>

#include <map>
#include <set>

namespace meristem {

namespace {

Affine3d placement(Vec3d position, Vec3d rotate, Vec3d scale) {
  const Vec3d r = rotate * (pi / 180);
  return Affine3d::translation(position) * Affine3d::rotation({0, 1, 0}, r.y) * Affine3d::rotation({1, 0, 0}, r.x) *
         Affine3d::rotation({0, 0, 1}, r.z) * Affine3d::scaling(scale);
}

// Scale as one number or three, none of them zero.
Vec3d read_scale(Params& params) {
  const Value* scale = params.raw(
      "scale", false,
      R"({"oneOf": [{"type": "number"}, )"
      R"({"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}], "default": 1})",
      "size: one number, or one along each axis");
  if (!scale) return Vec3d(1);
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

class ObjectBuilder {
 public:
  ObjectBuilder(const Value* models, const ModelContext& context) : models_(models), context_(context) {}

  void add(const Value& value) {
    if (value.kind != Value::Kind::Object)
      return context_.diagnostics.error(
          value.location, fmt::format("an object is {{\"model\": name, ...}}, found {}", value.kind_name()));
    Params params(value, "object", context_.diagnostics);
    const ObjectSection section = read_object(params);
    params.finish();
    if (auto model = model_of(section, params)) objects_.push_back({std::move(model), section.to_world});
  }

  // Models that no object names are checked all the same.
  void check_unused() {
    if (!models_) return;
    for (const Member& m : models_->members)
      if (!used_.count(m.key)) build_model(m.key, m.value, 0, context_);
  }

  std::vector<WorldObject> take() { return std::move(objects_); }

 private:
  std::shared_ptr<const Model> model_of(const ObjectSection& section, Params& params) {
    const Value* value = models_ ? models_->find(section.model) : nullptr;
    if (!value) {
      if (params.has("model")) params.error("model", unknown_model(section.model));
      return nullptr;
    }
    used_.insert(section.model);
    auto& model = built_[{section.model, section.seed}];
    if (!model.tried) model = {true, build_model(section.model, *value, section.seed, context_)};
    return model.model;
  }

  std::string unknown_model(const std::string& name) const {
    std::vector<std::string> names;
    if (models_)
      for (const Member& m : models_->members) names.push_back(m.key);
    const std::string_view near = nearest_name(name, names);
    return fmt::format("no model named \"{}\"{}; known: {}", name,
                       near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near), fmt::join(names, ", "));
  }

  struct Built {
    bool tried = false;
    std::shared_ptr<const Model> model;
  };
  const Value* models_;
  const ModelContext& context_;
  std::map<std::pair<std::string, int>, Built> built_;
  std::set<std::string> used_;
  std::vector<WorldObject> objects_;
};

}  // namespace

ObjectSection read_object(Params& params) {
  ObjectSection section;
  section.model = params.required_text("model", "name of one of the file's models");
  section.seed =
      params.integer("seed", 0, {0, 2147483647, ""}, "another seed grows another individual of the same kind");
  const Vec3d position = params.vector("position", {0, 0, 0}, any_range, "where the model's origin stands, in metres");
  const Vec3d rotate =
      params.vector("rotate", {0, 0, 0}, {-36000, 36000, "deg"}, "turns about x, y and z: first z, then x, then y");
  section.to_world = placement(position, rotate, read_scale(params));
  return section;
}

std::vector<WorldObject> build_objects(const Value* models, const Value* objects, const ModelContext& context) {
  ObjectBuilder builder(models, context);
  if (objects && objects->kind == Value::Kind::Array)
    for (const Value& object : objects->items) builder.add(object);
  else if (objects)
    context.diagnostics.error(objects->location,
                              fmt::format("\"objects\" is an array, found {}", objects->kind_name()));
  builder.check_unused();
  return builder.take();
}

}  // namespace meristem
