#include "procedural/plants/plant_detail.h"

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
  d.bend = std::clamp(to_degrees(8 * most / segment), d.bend, 120.0);
}

}  // namespace

PlantDetail plant_detail(const WeberPennParameters& p, int level, double radius, double segment, double footprint,
                         bool is_smoothed) {
  PlantDetail result;
  result.stem = full_detail(p, level, is_smoothed);
  if (footprint <= 0) return result;
  const double r = degradation::effective_range(footprint), s = 0.5 * p.quality, d = 200;
  coarsen(radius, segment, footprint, result.stem);
  if (level == 1) result.stem_share = degradation::branch_lines(r, s);
  if (level >= 2) result.stem_share = degradation::twig_lines(r, s);
  if (level + 1 < p.levels) return result;
  result.leaf_share = degradation::leaf_points(r, d);
  // The paper ends with one leaf of four; beyond, those that remain are about half a pixel
  const double leaf = p.leaf_scale / std::sqrt(p.quality);
  const double enough = 2 * leaf / footprint;
  if (result.leaf_share <= 0.25) result.leaf_share = std::min(result.leaf_share, enough * enough);
  result.leaf_share = std::max(result.leaf_share, 1 / (most_leaf_growth * most_leaf_growth));
  result.leaf_growth = 1 / std::sqrt(result.leaf_share);
  result.leaf_faces = degradation::leaf_faces(r, d);
  return result;
}

}  // namespace meristem
