// Scatter: parts strewn over a ground by density, with variation by expressions. A forest is one line of a scene file.
//
// What stands on a face of the ground is a pure function of the face: how many by its area and the density at its
// centroid (the fraction by chance), each one's place, turn, size and kind by hashes of the face's key and its number.
// So a cell of the ground can be furnished alone, when a ray comes near it, and forgotten again. Immutable; any thread.
#pragma once

#include "geometry/base/params.h"
#include "geometry/cells/part.h"
#include "geometry/fields/expression.h"

#include <memory>
#include <string>
#include <vector>

namespace meristem {

struct ScatterSettings {
  std::shared_ptr<const Expression> density;  // parts for each square metre of ground, over ground_symbols()
  std::shared_ptr<const Expression> scale;    // size of each part, over ground_symbols(); rand() differs by part
  double align = 0;                           // 0: upright, 1: at right angles to the ground
  double turn = 360;                          // degrees: each is turned about its axis by a random part of it
  double sink = 0;                            // metres that each stands below the ground, times its scale
  int variants = 0;                           // 0: every part is an individual of its own
  double distinct = 0;                        // pixels: what is seen larger is one of its own in spite of variants
};

// The variables of density and scale: P, N, u, v of the ground.
const Symbols& ground_symbols();

ScatterSettings read_scatter_settings(Params& params);

class Scatter final : public Placer {
 public:
  struct Choice {
    std::shared_ptr<const Part> part;
    double weight = 1;
    std::shared_ptr<const PartMoments> moments = nullptr;  // as in Placement
  };
  // Throws std::runtime_error if the scale has no bound.
  Scatter(ScatterSettings settings, std::vector<Choice> choices, Key seed);

  void place(const CellMesh& ground, Key individual, std::vector<Placement>& placements) const override;
  Bounds3f reach() const override { return reach_; }

 private:
  const Choice& choose(double random) const;
  Key variant(int index) const;
  void measure_variants();
  Bounds3f reach_of(const Bounds3f& part, double largest, bool is_upright) const;
  Placement placement(Vec3d position, Vec3d normal, double scale, Key key) const;

  const ScatterSettings settings_;
  const std::vector<Choice> choices_;
  const Key seed_;
  double total_weight_ = 0;
  std::vector<Bounds3f>
      known_bounds_;  // of every choice's variants, if these are few, keep still, and are not derived anyway
  Bounds3f reach_;
};

}  // namespace meristem
