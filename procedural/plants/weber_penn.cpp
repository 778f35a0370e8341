// weber_penn: a tree after Weber and Penn (SIGGRAPH 1995): the bud of its trunk, and one growth step a level.
//
//   "base": { "type": "weber_penn", "species": "quaking_aspen", "leaf_material": "leaf" },
//   "steps": [ { "subdivide": 2 }, { "subdivide": 1, "place": "..." } ]
//
// The species gives every parameter that the scene does not; lists go by level from the trunk on (null: as the
// species). Faces of stems carry the symbol stem(level, radius, length), those of leaves leaf(place, length), where
// place runs from 0 to 1 along the stem that bears the leaf: a material reads them as p0, p1, p2.
#include "procedural/growth/base_shape.h"
#include "procedural/plants/weber_penn_step.h"

#include <fmt/format.h>

namespace meristem {

namespace {

class WeberPenn : public BaseShape {
 public:
  explicit WeberPenn(Params& params)
      : parameters_(read_weber_penn(params)),
        footprint_(params.real("footprint", 0, {0, 1000, "m"},
                               "size of a pixel there, for trees that are always far away: "
                               "what is smaller is left out, what remains of the leaves grows")),
        leaf_material_(params.text("leaf_material", "", "name of the material of the leaves; else that of the model")) {
    if (!params.describing()) leaf_material_location_ = params.location_of("leaf_material");
    for (int i = 0; i < bud_parameter_count; ++i) trunk_.text += i == 0 ? bud_name(0) + "(0" : ",0";
    trunk_.text += ")";
    if (!params.describing()) trunk_.location = params.location();
  }

  std::vector<std::unique_ptr<Step>> growth(const BaseContext& context, bool is_refined) const override {
    auto plant = std::make_shared<WeberPennPlant>();
    plant->parameters = parameters_;
    plant->is_smoothed = is_refined;
    plant->footprint = footprint_;
    plant->seed = context.seed;
    const auto use = [&](const std::string& name, int count) {
      return std::int16_t(context.symbols.use(name, count, trunk_.location, context.diagnostics));
    };
    for (int level = 0; level < parameters_.levels; ++level)
      plant->bud_symbols.push_back(use(bud_name(level), bud_parameter_count));
    const std::int16_t stem_symbol = use("stem", 3);
    for (int level = 0; level < parameters_.levels; ++level)
      plant->stems.push_back({context.material, stem_symbol, context.production_number(stems_name(level))});
    plant->leaf_symbol = use("leaf", 2);
    plant->leaf_production = context.production_number("leaves");
    plant->leaf_material = context.material;
    if (!leaf_material_.empty() && context.material_index)
      plant->leaf_material = context.material_index(leaf_material_, leaf_material_location_);
    std::vector<std::unique_ptr<Step>> steps;
    for (int level = 0; level < parameters_.levels; ++level)
      steps.push_back(std::make_unique<WeberPennStep>(plant, level));
    return steps;
  }

 private:
  static std::string bud_name(int level) { return fmt::format("bud{}", level); }

  NamedFaces outline(BaseContext&) const override {
    NamedFaces faces;
    for (Vec3d p : bud_corners({{1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {0, 0, 0}})) faces.add_vertex(p);
    faces.add_face(0, {0, 1, 2}, {Vec2d{}, Vec2d{}, Vec2d{}});
    return faces;
  }
  const FaceSymbol* symbol_of(int) const override { return &trunk_; }

  WeberPennParameters parameters_;
  double footprint_;
  std::string leaf_material_;
  Location leaf_material_location_;
  FaceSymbol trunk_;
};

}  // namespace

void register_weber_penn(BaseRegistry& r) {
  r.add<WeberPenn>("weber_penn", "A tree after Weber and Penn, by species or by its own parameters");
}

}  // namespace meristem
