// Random rule systems over random closed bases, for tests of what must hold for all of them.
#pragma once

#include "tests/procedural/growth/derivation.h"

namespace meristem::test {

class RandomRules {
 public:
  explicit RandomRules(Key seed) : seed_(seed) {}

  std::string base() {
    switch (pick(4)) {
      case 0:
        return fmt::format(
            R"json({{ "type": "prism", "sides": {}, "radius": 0.4, "height": 0.7, "ridges": {}, "cap": "a({})",
    "side": "{}", "crease": {} }})json",
            3 + pick(7), pick(4), number(), pick(2) ? "a(0.5)" : "c", pick(2) * 1.5);
      case 1:
        return fmt::format(
            R"json({{ "type": "box", "size": [1, 0.5, 2], "top": "a({})", "bottom": "b(1, {})", "side": "c" }})json",
            number(), number());
      case 2:
        return fmt::format(
            R"json({{ "type": "sphere", "radius": 0.7, "divisions": {}, "face": "b({}, 0.5+rand())" }})json",
            1 + pick(2), number());
      default:
        return R"json({ "type": "mesh", "vertices": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]],
    "polygons": [[0,2,1],[0,1,3],[1,2,3],[0,3,2]],
                           "names": ["x","y","y","y"], "symbols": { "x": "a(0.3)", "y": "b(0.6, 0.2)" } })json";
    }
  }

  std::string steps(int count) {
    return fmt::format(
        R"json({{ "grow": {}, "light": [{}, {}, -{}], "rules": {{ "a(p)": {}, "b(p, q)": {}, "c": {} }} }})json", count,
        number(), number(), number(), rules({"p"}), rules({"p", "q"}), rules({}));
  }

 private:
  using Names = std::vector<std::string>;

  unsigned pick(unsigned n) { return unsigned(hash_keys(seed_, Key(counter_++)) % n); }
  std::string number() { return fmt::format("{:.3f}", 0.1 + 0.9 * uniform_double(hash_keys(seed_, Key(counter_++)))); }

  // An expression with values of moderate size.
  std::string scalar(const Names& parameters) {
    switch (pick(8)) {
      case 0: return number() + "+0.5*rand()";
      case 1: return parameters.empty() ? "radius" : parameters[pick(unsigned(parameters.size()))];
      case 2: return parameters.empty() ? "0.3+0.2*up" : number() + "*" + parameters[0];
      case 3: return "0.2+abs(u)*0.1+level*0.1";
      case 4: return "0.5+0.3*dot(frame_x, [0,1,0])";
      case 5: return "0.5+0.3*dot(frame_z, light)";
      case 6: return "0.2+0.15*min(neighbors, 4)";
      default: return number();
    }
  }
  std::string successor(const Names& parameters) {
    switch (pick(4)) {
      case 0: return fmt::format("a({})", scalar(parameters));
      case 1: return fmt::format("b({}, {})", scalar(parameters), scalar(parameters));
      case 2: return "c";
      default: return "";
    }
  }
  std::string angle(const Names& parameters) { return fmt::format("(100*({})-50)", scalar(parameters)); }

  std::string part(const Names& p) {
    switch (pick(9)) {
      case 0:
      case 1:
        return fmt::format(
            R"json("template": "segment", "length": "{}", "taper": "{}", "bend": "{}", "twist": "{}", "tropism": "{}",
    "faces": {{ "cap": "{}", "side": "{}" }})json",
            scalar(p), scalar(p), angle(p), angle(p), scalar(p), successor(p), successor(p));
      case 2:
        return fmt::format(
            R"json("template": "fork", "length": "{}", "angle": "{}", "balance": "{}", "left_radius": "{}",
    "roll": "{}", "tropism": "-{}", "halve": "{}", "faces": {{ "left": "{}", "right": "{}", "side": "{}" }})json",
            scalar(p), angle(p), scalar(p), scalar(p), angle(p), scalar(p), pick(2) ? "corners" : "edges", successor(p),
            successor(p), successor(p));
      case 3:
        return fmt::format(
            R"json("template": "box", "height": "{}", "taper": "{}", "crease": {}, "faces": {{ "top": "{}",
    "side": "{}", "front": "{}" }})json",
            scalar(p), scalar(p), pick(2), successor(p), successor(p), successor(p));
      case 4:
        return fmt::format(
            R"json("template": "tent", "height": "{}", "ridge": "{}", "faces": {{ "slope": "{}", "gable": "{}" }})json",
            scalar(p), scalar(p), successor(p), successor(p));
      case 5:
        return fmt::format(
            R"json("template": "spike", "length": "{}", "bend": "{}", "inset": {}, "faces": {{ "side": "{}",
    "rim": "{}" }})json",
            scalar(p), angle(p), pick(2) * 0.4, successor(p), successor(p));
      case 6:
        return fmt::format(
            R"json("template": "extrude", "inset": "{}", "height": "{}-0.5", "faces": {{ "cap": "{}",
    "wall": "{}" }})json",
            scalar(p), scalar(p), successor(p), successor(p));
      case 7:
        return fmt::format(
            R"json("template": "leaf", "length": "{}", "width": "{}", "stalk": "{}", "stalk_radius": "{}", "bend": "{}",
    "fold": "{}", "droop": "4*{}", "facing": "{}", "faces": {{ "blade": "{}", "stalk": "{}" }})json",
            scalar(p), scalar(p), scalar(p), scalar(p), angle(p), angle(p), angle(p), scalar(p), successor(p),
            successor(p));
      default:
        return fmt::format(
            R"json("template": "mesh", "scale": "{}", "height": "{}",
    "vertices": [[0,0,0],[0,1,0],[1,1,0],[1,0,0],[0.5,0.5,1.5]],
                                      "polygons": [[0,1,2,3],[1,0,4],[2,1,4],[3,2,4],[0,3,4]],
    "names": ["socket","tip","tip","other","other"], "faces": {{ "tip": "{}" }})json",
            scalar(p), scalar(p), successor(p));
    }
  }
  std::string rules(const Names& parameters) {
    std::string list;
    for (unsigned i = 0, n = 1 + pick(2); i < n; ++i)
      list += fmt::format(R"json({{ "weight": "{}", "if": "{}", {} }},)json", scalar(parameters),
                          pick(3) ? "1" : scalar(parameters) + " > 0.4", part(parameters));
    return "[" + list + "]";
  }

  Key seed_;
  Key counter_ = 0;
};

}  // namespace meristem::test
