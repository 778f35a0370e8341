// A small catalogue with every kind of parameter and every shape of component.
#pragma once

#include "renderer/language/catalogue.h"

namespace meristem::testing {

struct Anything {
  virtual ~Anything() = default;
};

struct Sky : Anything {
  explicit Sky(Params& p) {
    p.real("elevation", 40, {0, 90, "deg"}, "height of the sun above the horizon");
    p.integer("bands", 3, {1, 11, ""}, "of the spectrum");
    p.boolean("sun", true, "whether the disc of the sun shines as well");
    p.color("ground", Vec3d(0.3), "albedo of the ground");
    p.choice("model", 0, {"hosek", "preetham"}, "which fit to measured skies");
  }
};

struct Rectangle : Anything {
  explicit Rectangle(Params& p) {
    p.required_vector("corner", "where it begins");
    p.required_real("radiance", not_negative, "of its front");
    p.text("note", "", "");
  }
};

struct Pinhole : Anything {
  explicit Pinhole(Params& p) {
    p.vector("from", {0, 0, 5}, any_range, "the eye");
    p.real("fov", 40, {1, 170, "deg"}, "");
  }
};

struct Orthographic : Anything {
  explicit Orthographic(Params&) {}
};

struct Subdivide : Anything {
  explicit Subdivide(Params& p) {
    p.integer("subdivide", 1, {0, 20, ""}, "how often");
    p.raw("place", false, "{\"$ref\": \"#/definitions/vector_expression\"}", "displacement of new vertices");
  }
};

struct Grow : Anything {
  explicit Grow(Params& p) {
    p.integer("grow", 1, {0, 1000, ""}, "how often");
    p.raw("rules", true,
          R"({ "type": "object",
                "additionalProperties": { "type": "array", "items": { "$ref": "#/definitions/production" } } })",
          "productions by symbol");
  }
};

struct Production : Anything {
  explicit Production(Params& p) {
    p.raw("weight", false, "{\"$ref\": \"#/definitions/expression\"}", "for the choice");
  }
};

struct Segment : Anything {
  explicit Segment(Params& p) { p.real("taper", 1, not_negative, "of the far end"); }
};

struct Model : Anything {
  explicit Model(Params& p) {
    p.raw("steps", false, R"({"type": "array", "items": {"$ref": "#/definitions/step"}})", "in their order");
  }
};

inline Catalogue sample_catalogue() {
  Catalogue catalogue;
  const auto add = [&](const Registry<Anything>& registry) {
    for (ComponentInfo& info : registry.infos()) catalogue.components.push_back(std::move(info));
  };
  Registry<Anything> sections("section"), steps("step"), productions("production"), templates("template"),
      lights("light"), cameras("camera", true);
  sections.add<Model>("model", "a base mesh and steps");
  steps.add<Subdivide>("subdivide", "refines the mesh");
  steps.add<Grow>("grow", "replaces faces by rules");
  productions.add<Production>("production", "one way to replace a face");
  templates.add<Segment>("segment", "a prism on the face");
  lights.add<Sky>("sky", "Sun and clear sky");
  lights.add<Rectangle>("rectangle", "A lamp");
  cameras.add<Pinhole>("pinhole", "All in focus");
  cameras.add<Orthographic>("orthographic", "Parallel rays");
  for (const auto* registry : {&sections, &steps, &productions, &templates, &lights, &cameras}) add(*registry);
  catalogue.default_types["camera"] = "pinhole";
  return catalogue;
}

}  // namespace meristem::testing
