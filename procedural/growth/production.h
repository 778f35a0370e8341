// Production: one rule of a mesh-based parametric L-system, symbol + condition + weight -> template with symbols on its
// faces (the paper's section 4). GrowthRules: the rules of one entry of a model's steps, by symbol.
//
//   "rules": { "shoot(len)": [ { "weight": 2, "if": "len > 0.1", "template": "segment", "length": "len",
//                                "faces": { "cap": "shoot(len*0.92)" }, "material": "bark", "crease": 0 }, ... ] }
//
// All of it is data and expressions: read with every error at its place, then immutable; any thread may ask.
#pragma once

#include "procedural/growth/growth_symbols.h"
#include "procedural/growth/rule_variables.h"
#include "procedural/growth/template.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace meristem {

// What reading the grow steps of one model needs and fills; the caller keeps it until the last step is read.
struct GrowContext {
  const TemplateRegistry& templates;
  std::shared_ptr<GrowthSymbols> symbols;  // shared by base and steps
  Key seed = 0;                            // of the model: enters every random number, no key
  std::function<int(const std::string& name, const Location& where)> material_index;  // reports unknown names itself
  std::string folder = {};                                                            // of the scene's assets
  ProductionNumber production_number = no_production_numbers;
  int next_step = 0;  // grow steps made so far; names each step in the keys
};

class Production {
 public:
  // Reads `rule`, an object; `head` names it in messages ("shoot(len)"), `number` on faces that it makes. valid() tells
  // whether it can be used.
  Production(const Value& rule, const std::string& head, std::uint16_t number, const Symbols& variables,
             GrowContext& context, Diagnostics& diagnostics);
  // For the manual: what a rule may say besides its template's own parameters.
  static ComponentInfo info();

  bool valid() const { return valid_; }
  const Location& location() const { return location_; }
  const BoundTemplate& part() const { return part_; }
  float crease() const { return crease_; }
  bool uses_neighbors() const { return uses_neighbors_; }

  bool condition(std::span<const Vec3f> values, Key key, Key salt) const;
  double weight(std::span<const Vec3f> values, Key key, Key salt) const;  // at least 0
  void template_values(std::span<const Vec3f> values, Key key, Key salt, std::vector<Vec3d>& out) const;
  // What a new face of that name carries.
  FaceOrigin origin(int name, const FaceOrigin& parent, std::span<const Vec3f> values, Key parent_key, Key salt,
                    Key new_key) const;

  // Whether the production can be taken for values in the intervals, and whether it is then always a candidate.
  enum class Applies { Never, Maybe, Always };
  Applies applies(std::span<const IntervalValue> values) const;
  Interval weight_bounds(std::span<const IntervalValue> values) const;
  std::vector<Bounds3d> template_bounds(std::span<const IntervalValue> values) const;
  const std::vector<Successor>& successors() const { return successors_; }
  const Successor& successor(int name) const { return successors_[std::size_t(name)]; }

 private:
  void read_faces(const Value* faces, const Symbols& variables, GrowContext& context, Diagnostics& diagnostics);
  bool uses(int slot) const;

  Location location_;
  std::shared_ptr<const Expression> weight_, condition_;
  BoundTemplate part_;
  std::vector<Successor> successors_;  // one a name of the template
  int material_ = -1;                  // -1: that of the replaced face
  std::uint16_t number_ = no_production;
  float crease_ = 0;
  bool valid_ = false, uses_neighbors_ = false;
};

class GrowthRules {
 public:
  // Reads the object of rules; `last_step` is the last of the model's grow steps that uses them, `light` a unit vector.
  GrowthRules(const Value& rules, Vec3f light, int last_step, GrowContext& context, Diagnostics& diagnostics);

  // Reads which of the symbols thin, an object such as { "leaf": 4 }.
  void read_thinning(const Value& thinning, const GrowthSymbols& symbols, Diagnostics& diagnostics);

  // The direction of light that they see.
  Vec3f light() const { return light_; }
  // Whether what comes of a face depends on those beside it.
  bool uses_neighbors() const;

  // Below how many pixels what grows on faces with the symbol is thinned; 0: it is not.
  double thinning(std::int32_t symbol) const {
    return symbol >= 0 && std::size_t(symbol) < thinning_.size() ? thinning_[std::size_t(symbol)] : 0;
  }

  bool has_thinning() const {
    return std::any_of(thinning_.begin(), thinning_.end(), [](double pixels) { return pixels > 0; });
  }

  // The productions of a symbol; empty if it has none.
  std::span<const Production> of(std::int32_t symbol) const;
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (const auto& list : by_symbol_)
      for (const Production& p : list) visit(p);
  }

 private:
  void read_rule(const Member& rule, int last_step, GrowContext& context, Diagnostics& diagnostics);

  Vec3f light_;
  std::vector<std::vector<Production>> by_symbol_;
  std::vector<double> thinning_;  // by symbol
};

}  // namespace meristem
