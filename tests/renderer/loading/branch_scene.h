// A forking branch, small enough to expand whole in a test, with everything a model can do: it grows at random, is
// smoothed and displaced. As a scene file, and as a model cut into cells of any size.
#pragma once

#include "renderer/language/jsonc_reader.h"
#include "renderer/loading/load_model.h"

#include <string>

namespace meristem {

// `place` displaces the last two of the four subdivisions.
inline std::string branch_text(const std::string& place = "scale*N*.42*abs(sin(6*PI*u + .8*snoise(3*P)))") {
  return R"json({
    "base": { "type": "prism", "sides": 8, "radius": 0.34, "height": 0.5, "cap": "stem(.62, 1)" },
    "steps": [
      { "grow": 5, "rules": {
          "stem(len, k)": [
            { "if": "k > 0", "template": "segment", "length": "len", "taper": 0.91, "bend": "14*rand()",
              "bend_direction": "360*rand()", "tropism": 0.12, "faces": { "cap": "stem(len*.96, k - 1)" } },
            { "if": "k <= 0", "template": "fork", "length": "len*.75", "angle": "52 + 24*rand()",
              "balance": "rand(.3, .6)", "left_radius": 0.8, "right_radius": 0.7, "roll": "360*rand()",
              "faces": { "left": "stem(len*.82, 2)", "right": "stem(len*.72, 1)" } } ] } },
      { "subdivide": 2 },
      { "subdivide": 2, "place": ")json" +
         place + "\" } ] }";
}

inline std::string branch_scene() {
  return R"({ "format": 1, "models": { "branch": )" + branch_text() + R"( },
    "objects": [ { "model": "branch" },
                 { "model": "branch", "seed": 1, "position": [1, 0, -1], "rotate": [0, 40, 0] } ],
    "lights": [ { "type": "sky", "elevation": 32 } ],
    "camera": { "from": [2, 1.5, 4], "to": [0.3, 1.5, 0], "fov": 46 },
    "render": { "size": [64, 36], "samples": 1, "max_depth": 2 } })";
}

// Throws SceneErrors if the text is wrong.
inline std::shared_ptr<const Model> model_of(const std::string& text, int seed, CellSettings cells) {
  Diagnostics diagnostics;
  const Value value = read_jsonc(std::make_shared<SourceText>(SourceText{"model", text}), diagnostics);
  const auto no_materials = [](const std::string&, const Location&) { return 0; };
  auto model = build_model("branch", value, seed, {no_materials, "", diagnostics, cells});
  diagnostics.throw_if_errors();
  return model;
}

}  // namespace meristem
