// Models that place other models: the members "scatter" and "group" of a model in a scene file.
#pragma once

#include "geometry/cells/part.h"
#include "procedural/scatter/scatter.h"
#include "renderer/loading/load_model.h"
#include "renderer/loading/material_names.h"
#include "renderer/loading/shutter.h"

#include <compare>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace meristem {

struct ScatterSection {
  const Value* models = nullptr;  // a list of { "model": name, "weight": number }
  std::string on;                 // the model that makes the ground
  int levels = 0;                 // of its steps
  ScatterSettings settings;
};
ScatterSection read_scatter(Params& params);

struct GroupSection {
  const Value* objects = nullptr;
};
GroupSection read_group(Params& params);

// An object: a model in its place.
struct ObjectSection {
  std::string model;
  std::string name;  // for mattes; empty: that of the model, numbered if it stands more than once
  int seed = 0;
  std::vector<int> counts;  // of the model's steps, if not as the model says
  MaterialNames materials;
  Affine3d to_world;
};
// `check_material` reports names that are none.
ObjectSection read_object(
    Params& params, const MaterialNames::Check& check_material = [](const std::string&, const Location&) {});

// Where an object stands at a time, in frames; nothing, with an error, if its expressions go wrong there.
std::optional<Affine3d> object_transform(const Value& object, double time, Diagnostics& diagnostics);

// Names of a list of objects, for mattes: their own, or those of their models: "tree", or "tree 1", "tree 2" if there
// are several without a name.
std::vector<std::string> object_names(const Value& objects);

// Builds the models of a scene file when they are first named, once for each seed, counts and materials; those that
// change while the shutter is open once for each of its moments.
class PartLibrary {
 public:
  // `models`: the section as written; null if absent.
  PartLibrary(const Value* models, const ModelContext& context, const Shutter& shutter = {})
      : models_(models), scene_(context), context_(&context), shutter_(shutter) {}

  // The placements of a list of objects. Errors go to the diagnostics; what is wrong is left out.
  std::vector<Placement> place(const Value& objects);
  // The model that the member `name` of `params` names, for whoever needs its shape; null, with an error, if there is
  // none or it cannot be built.
  std::shared_ptr<const Part> named_part(const std::string& model, Params& params, const char* name) {
    const auto moments = part({model}, params, name);
    return moments ? moments->front() : nullptr;
  }
  // Whether anything that has been placed changes while the shutter is open.
  bool moves() const { return moves_; }
  // Models that nothing names are checked all the same.
  void check_unused();

 private:
  // Which individual of a model.
  struct Variant {
    std::string model;
    int seed = 0;
    std::vector<int> counts = {};
    MaterialNames materials = {};
    auto operator<=>(const Variant&) const = default;
  };

  // Of the model that the member `name` of `params` names. Null if there is none or it cannot be built.
  std::shared_ptr<const PartMoments> part(const Variant& variant, Params& params, const char* name);
  std::shared_ptr<const PartMoments> build_for_object(const Variant& variant, const Value& value, Params& params);
  std::shared_ptr<const PartMoments> build_moments(const Variant& variant, const Value& value, Params& params);
  std::shared_ptr<const Part> build(const Variant& variant, const Value& value, Params& params);
  std::shared_ptr<const Part> build(const std::string& name, const Value& value, int seed);
  std::shared_ptr<const Part> build_scatter(const std::string& name, const Value& value, int seed);
  std::shared_ptr<const Model> build_ground(const std::string& on, const Value& value, int levels, int seed);
  std::shared_ptr<const Part> build_group(const Value& value);
  std::vector<Scatter::Choice> read_choices(const Value& list, int seed);
  void add_object(const Value& value, std::vector<Placement>& placements);
  std::shared_ptr<const Motion> motion_of(const Value& object, const Affine3d& opening);
  std::string unknown_model(const std::string& name) const;

  const Value* models_;
  const ModelContext& scene_;
  const ModelContext* context_;  // of the model that is being built
  MaterialNames materials_;      // of the object that it is built for
  const Shutter shutter_;
  bool moves_ = false;
  std::map<Variant, std::shared_ptr<const PartMoments>> built_;
  // By name, levels and seed, of those that do not change: what stands on one shares its cells.
  std::map<std::tuple<std::string, int, int>, std::shared_ptr<const Model>> grounds_;
  std::set<std::string> under_construction_;
  std::set<std::string> used_;
};

}  // namespace meristem
