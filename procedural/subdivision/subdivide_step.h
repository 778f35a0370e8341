// SubdivideStep: one level of generalized subdivision (Tobler, Maierhofer and Wilkie, section 3): mesh refinement by a
// scheme, then vertex placement: the scheme's smooth position plus a displacement vector from an expression.
#pragma once

#include "geometry/cells/step.h"
#include "geometry/fields/expression.h"
#include "geometry/mesh/refine.h"

#include <memory>

namespace meristem {

// What a placement expression may read: P, N, scale, T, B, u, v, level, kind, and the parameters p0 ... p7 of the
// symbol of the faces around, of whose range nothing is known beforehand; rand() is keyed by the vertex.
const Symbols& placement_symbols();

class SubdivideStep final : public Step {
 public:
  struct Settings {
    RefineOptions refine;
    std::shared_ptr<const Expression> place;  // a displacement vector over placement_symbols(); null: plain smoothing
    int level = 1;                            // of subdivision, counted over the whole model from 1
    Key step_key = 0;
    Quantum quantum;
  };
  explicit SubdivideStep(Settings settings) : settings_(std::move(settings)) {}

  std::string name() const override;
  int halo_rings(int rings_after) const override { return refine_halo_rings(rings_after, settings_.refine.creasing); }
  std::uint32_t max_children(std::uint32_t corners) const override;
  // Throws std::runtime_error when the placement gives a position that is not finite.
  void apply(const CellMesh& in, int rings_after, CellMesh& out) const override;
  Extent bound(const Extent& e) const override;
  bool displaces() const override { return settings_.place != nullptr; }
  bool refines() const override { return true; }
  std::optional<RefineOptions> refinement() const override { return settings_.refine; }
  double offset_bound(const Extent& before, double scale) const override;
  void set_quantum(const Quantum& quantum) override { settings_.quantum = quantum; }

 private:
  // Of the displacement of vertices in that extent whose local scale is at most `scale`.
  IntervalValue placement_bounds(const Extent& e, double scale) const;
  void place_vertices(const Mesh& before, const RefinePlan& plan, const RefinedMesh& refined, Mesh& mesh) const;

  Settings settings_;
};

}  // namespace meristem
