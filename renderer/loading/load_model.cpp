#include "renderer/loading/load_model.h"

#include "geometry/mesh/adjacency.h"
#include "procedural/growth/forecast.h"
#include "procedural/growth/grow_step.h"
#include "procedural/subdivision/subdivide.h"
#include "renderer/loading/all_components.h"

#include <fmt/format.h>

#include <algorithm>

namespace meristem {

namespace {

constexpr int most_levels = 64;

class ModelBuilder {
 public:
  ModelBuilder(const std::string& name, const Value& value, int seed, const ModelContext& context)
      : name_(name),
        context_(context),
        diagnostics_(context.diagnostics),
        seed_(hash_keys(hash_text(name), Key(seed))),
        value_(value) {}

  std::shared_ptr<const Model> build() {
    const std::size_t errors_before = diagnostics_.errors_found();
    Params params(value_, fmt::format("model \"{}\"", name_), diagnostics_);
    const ModelSection section = read_model(params);
    params.finish();
    if (!section.base) return nullptr;

    Mesh base = build_base(section, params);
    if (section.steps) read_steps(*section.steps);
    if (context_.levels > 0 && std::size_t(context_.levels) < steps_.size())
      steps_.resize(std::size_t(context_.levels));
    symbols_->report_terminals(diagnostics_);
    if (diagnostics_.errors_found() > errors_before) return nullptr;
    symbols_->report_unreachable(diagnostics_);
    check_corner_counts(base, steps_, step_places_, diagnostics_);
    if (diagnostics_.errors_found() > errors_before) return nullptr;
    try {
      return std::make_shared<const Model>(seed_name(), std::move(base), std::move(steps_), context_.cells);
    } catch (const std::runtime_error& error) {
      diagnostics_.error(value_.location, error.what());
      return nullptr;
    }
  }

 private:
  std::string seed_name() const { return fmt::format("{}#{:x}", name_, seed_); }

  Mesh build_base(const ModelSection& section, Params& params) {
    const int material = context_.material_index(section.material, params.location_of("material"));
    const std::size_t found_before = diagnostics_.found();
    const auto shape = all_components().bases.create(*section.base, "", diagnostics_);
    if (!shape) return {};
    const Value* type = section.base->find("type");
    BaseContext context{*symbols_,
                        diagnostics_,
                        seed_,
                        material,
                        context_.folder,
                        context_.material_index,
                        production_number(type ? type->text : ""),
                        grow_context_.production_number};
    Mesh mesh = shape->build(context);
    steps_ = shape->growth(context, section.steps && has_subdivision(*section.steps));
    for (int symbol = 0; symbol < symbols_->size(); ++symbol) symbols_->put_on_base(symbol);
    if (const std::string defect = manifold_defect(mesh); !defect.empty())
      diagnostics_.error(section.base->location, fmt::format("the base mesh is not a manifold: {}", defect));
    else if (mesh.face_count() == 0 && diagnostics_.found() == found_before)  // else it has been said why
      diagnostics_.error(section.base->location, "the base mesh has no faces");
    return mesh;
  }

  std::uint16_t production_number(const std::string& production) const {
    return context_.production_number(fmt::format("{}/{}", name_, production));
  }

  static bool has_subdivision(const Value& steps) {
    return std::any_of(steps.items.begin(), steps.items.end(),
                       [](const Value& step) { return step.find("subdivide") != nullptr; });
  }

  void read_steps(const Value& steps) {
    if (steps.kind != Value::Kind::Array)
      return diagnostics_.error(steps.location,
                                fmt::format("\"steps\" is an array of steps, found {}", steps.kind_name()));
    step_places_.resize(steps_.size(), steps.location);  // those of the base
    for (const Value& step : steps.items) {
      read_step(step);
      const Value* const scheme = step.find("scheme");
      step_places_.resize(steps_.size(), scheme ? scheme->location : step.location);
    }
    if (int(steps_.size()) > most_levels)
      diagnostics_.error(steps.location,
                         fmt::format("the steps make {} levels; the limit is {}", steps_.size(), most_levels));
  }

  void read_step(const Value& step) {
    const bool is_object = step.kind == Value::Kind::Object;
    if (is_object && step.find("subdivide")) {
      Params params(step, "step \"subdivide\"", diagnostics_);
      auto made = read_subdivide(params, subdivisions_ + 1, hash_keys(seed_, 1, step_count_++));
      params.finish();
      for (auto& s : made) {
        subdivisions_ += s->refines();
        steps_.push_back(std::move(s));
      }
    } else if (is_object && step.find("grow")) {
      for (auto& s : make_grow_steps(step, grow_context_, diagnostics_)) steps_.push_back(std::move(s));
    } else {
      diagnostics_.error(step.location, "a step is an object with \"subdivide\" or \"grow\"");
    }
  }

  const std::string name_;
  const ModelContext& context_;
  Diagnostics& diagnostics_;
  const Key seed_;
  const Value& value_;
  std::shared_ptr<GrowthSymbols> symbols_ = std::make_shared<GrowthSymbols>();
  GrowContext grow_context_{all_components().templates,
                            symbols_,
                            seed_,
                            context_.material_index,
                            context_.folder,
                            [this](const std::string& production) { return production_number(production); }};
  std::vector<std::unique_ptr<Step>> steps_;
  std::vector<Location> step_places_;
  int subdivisions_ = 0;
  Key step_count_ = 0;
};

}  // namespace

ModelSection read_model(Params& params) {
  ModelSection section;
  section.base = params.raw("base", true, R"({"$ref": "#/definitions/base"})", "the mesh to start from");
  section.material = params.text("material", "", "name of the material of all faces that say nothing else");
  section.steps = params.raw("steps", false, R"({"type": "array", "items": {"$ref": "#/definitions/step"}})",
                             "subdivide and grow steps, in order");
  return section;
}

std::shared_ptr<const Model> build_model(const std::string& name, const Value& value, int seed,
                                         const ModelContext& context) {
  std::shared_ptr<const Model> model = ModelBuilder(name, value, seed, context).build();
  if (model && context.on_model) context.on_model(name, *model);
  return model;
}

}  // namespace meristem
