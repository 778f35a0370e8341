// Scatter: parts strewn over a ground by density, with variation by expressions. A forest is one line of a scene file.
//
// What stands on a face of the ground is a pure function of the face: how many by its area and the density at its
// centroid (the fraction by chance), each one's place, turn, size and kind by hashes of the face's key and its number.
// So a cell of the ground can be furnished alone, when a ray comes near it, and forgotten again. Immutable; any thread.
#pragma once

#include "geometry/base/params.h"
#include "geometry/cells/part.h"
#include "geometry/fields/expression.h"

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <tuple>
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

  std::unique_ptr<const Furnishing> furnish(const CellMesh& ground, Key individual) const override;
  bool leaves_bare(const Bounds3f& ground) const override;
  Bounds3f reach() const override { return reach_.all; }
  Bounds3f typical_reach() const override { return typical_reach_; }
  // Where all is seen so small that variants stand there, theirs. Some milliseconds for a footprint that is new.
  std::shared_ptr<const PlacedReach> reach_on(const Bounds3f& ground, const Footprint* footprint,
                                              Key individual) const override;
  bool enlarges() const override { return enlarges_; }

 private:
  class OnCell;
  // A footprint by its step (footprint_step()), and the individual that the ground is of.
  struct SeenAs {
    int step;
    bool fades;
    Key individual;
    auto operator<=>(const SeenAs&) const = default;
  };
  const Choice& choose(double random) const;
  Key variant(int index) const;
  int variant_of(Key key) const;
  std::size_t kind(const Choice& choice, int variant) const {
    return std::size_t(&choice - choices_.data()) * std::size_t(settings_.variants) + std::size_t(variant);
  }
  void measure_variants();
  std::shared_ptr<const PlacedReach> enlarged_reach(const Bounds3f& ground, const Footprint* footprint,
                                                    bool is_known) const;
  std::shared_ptr<const PlacedReach> reach_up_to(int step, const Footprint* footprint, bool is_known) const;
  Bounds3f reach_of(const Bounds3f& part, double scale) const;
  const std::vector<Bounds3f>& variant_bounds(const SeenAs& seen_as) const;
  void forget_if_many() const;  // needs mutex_
  Placement placement(Vec3d position, Vec3d normal, double scale, Key key, bool is_known) const;

  const ScatterSettings settings_;
  const std::vector<Choice> choices_;
  const Key seed_;
  double total_weight_ = 0;
  double smallest_scale_ = 0, largest_scale_ = 0;  // the magnitudes
  bool is_upright_ = false;                        // and never upside down
  bool has_moments_ = false;
  bool enlarges_ = false;
  // In full, by kind(), if variants are few, keep still, and are not derived anyway. Where the ground is of an
  // individual of its own so are they: then nothing is known of them.
  std::vector<Bounds3f> known_bounds_;
  PlacedReach reach_, known_reach_;
  Bounds3f typical_reach_;                                          // of the boxes by which placed_footprint() decides
  double typical_size_ = 0;                                         // the largest side of one of these
  mutable std::mutex mutex_;                                        // held for a look-up at each box of ground
  mutable std::map<SeenAs, std::vector<Bounds3f>> variant_bounds_;  // by kind(); guarded by mutex_
  // Up to a step; guarded by mutex_
  mutable std::map<std::pair<SeenAs, int>, std::shared_ptr<const PlacedReach>> reaches_;
};

}  // namespace meristem
