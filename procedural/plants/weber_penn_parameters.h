// The parameters of the tree model of Weber and Penn (SIGGRAPH 1995, "Creation and Rendering of Realistic Trees"),
// under the names of its appendix, and the published species.
//
// Levels: 0 the trunk, 1 its branches, 2 and 3 theirs; deeper levels are like level 3. Leaves count as the level
// `levels` and take their angles from it. Angles are degrees, lengths metres. A value of the paper written "a, aV" is a
// plus a uniform random number in +-aV; a negative value of some is a mode, said at the field. Plain data.
#pragma once

#include "geometry/base/params.h"

#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>

namespace meristem {

constexpr int plant_level_kinds = 4;

// What every level has of its own.
struct PlantLevel {
  double length = 1, length_v = 0;  // of the parent's length at most; level 0: of the tree's scale
  double taper = 1;                 // 0 cylinder, 1 cone, 2 round end, 3 row of spheres
  double seg_splits = 0;            // clones for each segment, on average
  double split_angle = 0, split_angle_v = 0;
  double curve_res = 3;                     // segments
  double curve = 0, curve_back = 0;         // bend; with curve_back: of the first half, and of the second
  double curve_v = 0;                       // random bend; negative: a helix of that declination
  double bend_v = 0;                        // random bend out of the plane of `curve`; not in the paper
  double down_angle = 0, down_angle_v = 0;  // from the parent; a negative V: varies with the place on the parent
  double rotate = 0, rotate_v = 0;          // around the parent; negative: to alternate sides
  double branches = 0;                      // most children of a parent of that level; negative: a fan at its end
};

constexpr int most_stem_levels = 6;

struct WeberPennParameters {
  int shape = 7;  // a crown shape
  double base_size = 0.4, scale = 13, scale_v = 3, z_scale = 1, z_scale_v = 0;
  int levels = 3;
  double ratio = 0.015, ratio_power = 1.2;
  int lobes = 5;
  double lobe_depth = 0.07, flare = 0.6;
  double trunk_scale = 1, trunk_scale_v = 0;  // 0Scale, 0ScaleV
  int base_splits = 0;
  std::array<PlantLevel, plant_level_kinds> level;
  double leaves = 25;  // of a stem of the last level; negative: a fan at its end
  int leaf_shape = 0;
  double leaf_scale = 0.17, leaf_scale_x = 1, leaf_bend = 0.3;
  double attraction_up = 0.5;
  double prune_ratio = 0, prune_width = 0.5, prune_width_peak = 0.5, prune_power_low = 0.5, prune_power_high = 0.5;
  double quality = 1;

  const PlantLevel& at(int n) const { return level[std::size_t(std::min(n, plant_level_kinds - 1))]; }
};

inline double leaf_length(const WeberPennParameters& p) { return p.leaf_scale / std::sqrt(p.quality); }

// ShapeRatio of the paper (section 4.2), by the shapes 0 conical, 1 spherical, 2 hemispherical, 3 cylindrical, 4
// tapered cylindrical, 5 flame, 6 inverse conical, 7 tend flame. `r` is clamped to 0 ... 1. Shape 8 is
// prune_shape_ratio().
double shape_ratio(int shape, double r);
// The envelope of pruning (section 4.6), with the peak where the paper misprints 1 - peak in the lower part.
double prune_shape_ratio(const WeberPennParameters& p, double r);
// Either of them.
double crown_shape_ratio(const WeberPennParameters& p, double r);

// The radius of a stem of that length and base radius at the fraction z of it, by the modes of taper (section 4.4).
double tapered_radius(double taper, double length, double radius, double z);

struct PlantSpecies {
  const char* name;
  const char* doc;
  WeberPennParameters parameters;
};
// The four trees of the paper's appendix first, others behind.
std::span<const PlantSpecies> plant_species();

// "species", and every parameter over what the species has.
WeberPennParameters read_weber_penn(Params& params);

const std::vector<std::string>& crown_shape_names();

}  // namespace meristem
