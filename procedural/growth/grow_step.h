// GrowStep: one level of rule based mesh growing (the paper's sections 4 and 5). Every face whose symbol has a
// production with a true condition is replaced by the production's template, welded to the face's border; all others
// stay.
//
//   { "grow": 5, "rules": { "shoot(len)": { "template": "segment", "length": "len", "faces": { "cap": "shoot(len*0.92)"
//   } } } }
//
// is five such steps. What grows on a face depends on that face alone - its corners in their order, its u, v, its
// symbol and key - and new positions lie on the model's grid, so every cell that holds the face grows the same bits; a
// halo of r rings needs no more than r rings before. Rules that count a face's neighbours need one ring more: the faces
// of the last ring then grow wrongly, but nothing of them is left, since a child is no nearer than its parent. New
// keys: hash(face key, step, vertex or face, index in the template). While the mesh has u, v by corners, new faces get
// their own; after a subdivision new vertices get the mean over their new faces.
//
// A template that cannot stand on the face (a fork on a triangle) leaves the face as it is, without its symbol;
// check_corner_counts() of forecast.h finds these while loading.
#pragma once

#include "geometry/cells/step.h"
#include "procedural/growth/production.h"

#include <array>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace meristem {

// Faces by the symbol they carry (-1: none) and their number of corners, for estimates.
using FaceCensus = std::map<std::pair<std::int32_t, std::uint32_t>, double>;

class GrowStep : public Step {
 public:
  // `index`: of the model's grow steps; `level`: of the steps of its entry; `before`: one with the same rules.
  GrowStep(std::shared_ptr<const GrowthRules> rules, std::shared_ptr<const GrowthSymbols> symbols, int index, int level,
           Key seed, const GrowStep* before = nullptr);

  std::string name() const override;
  int halo_rings(int rings_after) const override { return rings_after + (rules_->uses_neighbors() ? 1 : 0); }
  std::uint32_t max_children(std::uint32_t corners) const override;
  void apply(const CellMesh& in, int rings_after, CellMesh& out) const override;
  Extent bound(const Extent& e) const override;
  bool grows(std::int32_t symbol) const override { return !rules_->of(symbol).empty(); }
  double thinning(std::int32_t symbol) const override { return rules_->thinning(symbol); }
  bool enlarges() const override { return rules_->has_thinning(); }
  std::string symbol_name(std::int32_t symbol) const override { return symbols_->entry(symbol).name; }

  // The grid of new vertices. To be set before the first apply(), by the loader.
  void set_quantum(const Quantum& quantum) { quantum_ = quantum; }

  // The faces after the step: the expected number where all weights are constant and all conditions certain for the
  // region's ranges, an upper bound elsewhere.
  FaceCensus forecast(const FaceCensus& faces, const Extent& extent) const;
  const GrowthRules& rules() const { return *rules_; }

 private:
  class Application;
  const Production* choose(std::span<const Production> candidates, std::span<const Vec3f> values, Key face_key) const;
  std::uint32_t count_children(std::uint32_t corners) const;
  Key production_salt(const Production& p, std::span<const Production> list) const;
  bool grows_later(std::int32_t symbol) const;
  RuleSurroundings surroundings(int neighbors = 0) const { return {level_, rules_->light(), neighbors}; }
  // Adds what comes of one production to the extent after the step.
  void add_growth(const Production& p, const SymbolRange& parent, const Extent& before,
                  std::span<const IntervalValue> values, Extent& after) const;

  std::shared_ptr<const GrowthRules> rules_;
  std::shared_ptr<const GrowthSymbols> symbols_;
  int index_, level_;
  Key key_salt_, random_salt_;
  Quantum quantum_;
  // By corners, since it is asked for every face and every level to come.
  std::array<std::uint32_t, 9> most_children_{};
};

// Reads the steps of an object that has the member "grow". Errors go to diagnostics; then the steps must not be used.
std::vector<std::unique_ptr<GrowStep>> make_grow_steps(const Value& step_object, GrowContext& context,
                                                       Diagnostics& diagnostics);
// For the manual and the schema: kind "step", name "grow".
ComponentInfo grow_step_info();

}  // namespace meristem
