// WeberPennStep: one level of a tree of Weber and Penn: every bud of the level is replaced by its whole stem, a closed
// component of the mesh, with the buds of its children; on stems of the last level leaves grow at once.
//
// A bud is a single triangle without neighbours, on the axis of its parent: its face frame is the frame of the stem (z
// along it), its symbol names the level, its parameters are what the stem needs of its parent, and its key is the
// source of all randomness. So a stem depends on its bud alone, and a step needs no halo. The triangle itself vanishes.
#pragma once

#include "geometry/cells/step.h"
#include "procedural/plants/plant_detail.h"

#include <memory>

namespace meristem {

// What the steps of one tree share.
struct WeberPennPlant {
  WeberPennParameters parameters;
  std::vector<std::int16_t> bud_symbols;  // by level
  std::vector<StemFaces> stems;           // by level
  std::int32_t leaf_material = -1;
  std::int16_t leaf_symbol = -1;
  std::uint16_t leaf_production = no_production;
  bool is_smoothed = false;  // whether subdivision follows
  double footprint = 0;      // metres; what is smaller need not be drawn
  Key seed = 0;              // enters every random number

  // By the key of its bud's face.
  Key key_of_stem(Key bud) const { return hash_keys(bud, seed); }
};

// What stems of a level are called: "trunk", "branches", ...
std::string stems_name(int level);

constexpr int bud_parameter_count = 5;  // length, radius, children, inset, scale

class WeberPennStep final : public Step {
 public:
  WeberPennStep(std::shared_ptr<const WeberPennPlant> plant, int level);

  std::string name() const override;
  int halo_rings(int rings_after) const override { return rings_after; }
  std::uint32_t max_children(std::uint32_t corners) const override;  // about so many, for cutting cells
  void apply(const CellMesh& in, int rings_after, CellMesh& out) const override;
  Extent bound(const Extent& e) const override;
  std::optional<DerivedBounds> derive(const CellMesh& in, std::uint32_t face, int levels) const override;
  bool grows(std::int32_t symbol) const override { return symbol == bud_symbol(level_); }
  std::string symbol_name(std::int32_t symbol) const override { return grows(symbol) ? "bud of " + name() : ""; }
  bool thins() const override { return true; }
  double thinned_faces(const FaceOrigin& bud, double footprint, double refined) const override;
  void set_quantum(const Quantum& quantum) override { quantum_ = quantum; }
  void set_shown_quantum(const Quantum& quantum) override { shown_quantum_ = quantum; }

 private:
  class Application;
  class Derivation;
  double expected_faces(int level, double length, double radius, double footprint, double refined) const;
  StemBud bud_of(const CellMesh& in, std::uint32_t face) const;
  double footprint_at(const CellMesh& in, Vec3d root) const {
    return in.footprint ? std::max(plant_->footprint, in.footprint->at(root)) : plant_->footprint;
  }
  std::int16_t bud_symbol(int level) const { return plant_->bud_symbols[std::size_t(level)]; }
  bool is_last() const { return level_ + 1 == plant_->parameters.levels; }

  std::shared_ptr<const WeberPennPlant> plant_;
  const int level_;
  Quantum quantum_, shown_quantum_;
};

// The triangle of a bud: corners in order, so that its face frame is `frame`.
std::array<Vec3d, 3> bud_corners(const Affine3d& frame);

}  // namespace meristem
