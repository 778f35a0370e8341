#include "procedural/plants/plant_detail.h"

#include "procedural/plants/leaf_shape.h"

#include <cmath>

namespace meristem {

namespace degradation {

namespace {

double unit(double x) { return std::clamp(x, 0.0, 1.0); }

}  // namespace

double effective_range(double footprint) { return footprint * 1000 / to_radians(60); }

double trunk_faces(double r) { return r < 800 ? unit(1.5 - r / 600) : 0; }
double branch_faces(double r, double s) { return r < 200 * s ? unit(1.5 - r / 600) : 0; }
double branch_lines(double r, double s) {
  return r < 200 * s ? 1 : r < 2000 * s ? unit(2.2 - 1.2 * std::pow(r / (200 * s), 0.3)) : 0;
}
double twig_faces(double r, double s) { return r < 100 * s ? unit(2 - r / (50 * s)) : 0; }
double twig_lines(double r, double s) { return r < 500 * s ? unit(2 - std::sqrt(r / (100 * s))) : 0; }
double leaf_faces(double r, double d) { return unit(4.0 / 3 - r / (0.75 * d)); }
double leaf_points(double r, double d) { return std::max(unit(1.5 - r / (2 * d)), 0.25); }

}  // namespace degradation

namespace {

// An error of less than this part of a pixel does not matter.
constexpr double tolerance = 0.25;

StemDetail full_detail(const WeberPennParameters& p, int level, bool is_smoothed) {
  StemDetail d;
  d.is_smoothed = is_smoothed;
  if (level == 0) {
    d.sides = std::clamp((2 * std::uint32_t(p.lobes) + 5) / 4 * 4, 16u, 64u);
    d.most_rings = 8;
  } else if (level == 1) {
    d.sides = 8;
  } else {
    d.sides = 4;
    d.most_rings = 1;
    d.bend = 30;
  }
  return d;
}

// Fewer sides and rings as long as the outline moves by less than the tolerance.
void coarsen(double radius, double segment, double footprint, StemDetail& d) {
  const double most = tolerance * footprint;
  while (d.sides >= 8 && d.sides % 8 == 0 && radius * (1 - std::cos(2 * pi / d.sides)) < most) d.sides /= 2;
  if (radius < footprint) d.most_rings = 1;
  d.has_flare = radius > footprint;
  d.is_final = 2 * radius < 1.5 * footprint;
  d.is_smoothed = d.is_smoothed && !d.is_final;
  d.bend = std::clamp(to_degrees(8 * most / segment), d.bend, 120.0);
}

// Leaves merge where they would be smaller than this many pixels.
constexpr double smallest_card = 2;
// No fewer remain of a whole tree.
constexpr double fewest_leaves = 12;
// Where some stems stand for all, they are this many pixels wide.
constexpr double narrowest_ribbon = 0.5;
// On stems leaves and twigs are fewer than the most, by the shapes that the paper gives them.
constexpr double mean_of_most_children = 0.75;

double expected_leaves(const WeberPennParameters& p) {
  double count = 1;
  for (int level = 0; level < p.levels; ++level) count *= mean_of_most_children * expected_children(p, level);
  return count;
}

// The mean length of stems of a level.
double mean_length(const WeberPennParameters& p, int level) {
  constexpr double mean_of_longest = 0.7;
  double length = p.scale * p.level[0].length;
  for (int i = 1; i <= level; ++i) length *= mean_of_longest * p.at(i).length;
  return length;
}

// How many children a stem has at least, on average, while whole stems are left out. Foliage stands in clumps, one a
// stem of the last level, whose leaves hide and shade each other: cards that are scattered more evenly cover more, and
// are brighter; the more so, the smaller a card is beside its stem. Measured, so that crowns keep cover and luminance.
double fewest_children(const WeberPennParameters& p, int level, double card) {
  if (level + 1 < p.levels) return 1.5;
  return std::max(1.0, 3.7 * std::pow(mean_length(p, level) / card, 0.6));
}

// Cards of several leaves are rounder than one that is long and narrow.
void merge_leaves(const WeberPennParameters& p, double share, PlantDetail& d) {
  const double leaf = leaf_length(p), area = leaf * leaf * p.leaf_scale_x / share;
  const double aspect = std::pow(p.leaf_scale_x, std::sqrt(share));
  d.leaf_length = std::sqrt(area / aspect);
  d.leaf_width = d.leaf_length * aspect;
  d.are_cards = share < 1;
}

}  // namespace

double kept_share(const WeberPennParameters& p, int level, double footprint) {
  return KeptShares(p, footprint).of(level);
}

KeptShares::KeptShares(const WeberPennParameters& p, double footprint) : footprint_(footprint) {
  shares_.fill(1);
  if (footprint <= 0) return;
  const double card = smallest_card * footprint / leaf_length(p);
  const double table = degradation::leaf_points(degradation::effective_range(footprint), 200);
  const double share = std::min(table, p.leaf_scale_x / (card * card));
  shares_[std::size_t(p.levels)] = std::clamp(share, std::min(1.0, fewest_leaves / expected_leaves(p)), 1.0);
  for (int level = p.levels; --level > 0;) {
    // Whole stems are left out only where children are, even if none ever bears as many as are wanted on those that
    // stay
    if (expected_children(p, level) == 0) continue;
    const double children = mean_of_most_children * expected_children(p, level);
    const double fewest = std::min(children, fewest_children(p, level, smallest_card * footprint));
    shares_[std::size_t(level)] = std::min(1.0, of(level + 1) * children / fewest);
  }
}

PlantDetail plant_detail(const WeberPennParameters& p, int level, double radius, double segment, double footprint,
                         bool is_smoothed) {
  return plant_detail(p, level, radius, segment, KeptShares(p, footprint), is_smoothed);
}

PlantDetail plant_detail(const WeberPennParameters& p, int level, double radius, double segment,
                         const KeptShares& shares, bool is_smoothed) {
  const double footprint = shares.footprint();
  PlantDetail result;
  result.stem = full_detail(p, level, is_smoothed);
  const bool bears_leaves = level + 1 == p.levels;
  if (bears_leaves) merge_leaves(p, shares.of(p.levels), result);
  if (footprint <= 0) return result;
  const double r = degradation::effective_range(footprint), s = 0.5 * p.quality, d = 200;
  coarsen(radius, segment, footprint, result.stem);
  const double kept = shares.of(level);
  result.stem.is_ribbon = result.stem.is_final && (level > 0 || 2 * radius < narrowest_ribbon * footprint);
  result.child_share = shares.of(level + 1) / kept;
  if (bears_leaves) result.leaf_faces = result.are_cards ? 0 : degradation::leaf_faces(r, d);
  if (level == 0) return result;
  // The share of the paper, and at least as many as are about half a pixel wide when they stand for all
  const double table = level == 1 ? degradation::branch_lines(r, s) : degradation::twig_lines(r, s);
  const double shown = std::min(kept, std::max(table, 2 * radius / (narrowest_ribbon * footprint)));
  result.stem_share = shown / kept;
  result.stem.widening = 1 / shown;
  return result;
}

double longest_leaf(const WeberPennParameters& p) {
  PlantDetail d;
  merge_leaves(p, std::min(1.0, fewest_leaves / expected_leaves(p)), d);
  return std::max(leaf_length(p), d.leaf_length);
}

double leaf_reach(const WeberPennParameters& p, double length, double width) {
  const LeafShape& shape = leaf_shape(p.leaf_shape);
  const double leaf = leaf_length(p), whole = leaf * shape.reach * std::max(p.leaf_scale_x, 1.0);
  // Cards lie around the middle of the leaf that they grow from
  return std::max({whole, 0.5 * (length + leaf), std::hypot(0.5 * leaf, shape.area * width)});
}

}  // namespace meristem
