#include "procedural/plants/weber_penn_parameters.h"

#include "procedural/plants/leaf_shape.h"

#include <fmt/format.h>

#include <cmath>

namespace meristem {

namespace {

// A parameter that every level has: in a scene file a list, the trunk first.
struct LevelField {
  const char* name;
  double PlantLevel::*member;
  Range range;
  const char* doc;
};

constexpr LevelField level_fields[] = {
    {"length", &PlantLevel::length, {0, 10, ""}, "greatest length in lengths of the parent; trunk: in scales"},
    {"length_v", &PlantLevel::length_v, {0, 10, ""}, "variation of it"},
    {"taper", &PlantLevel::taper, {0, 3, ""}, "0 cylinder, 1 cone, 2 round end, 3 row of spheres"},
    {"seg_splits", &PlantLevel::seg_splits, {0, 4, ""}, "clones made at the end of a segment, on average"},
    {"split_angle", &PlantLevel::split_angle, {0, 180, "deg"}, "by which stems that split lean away"},
    {"split_angle_v", &PlantLevel::split_angle_v, {0, 180, "deg"}, "variation of it"},
    {"curve_res", &PlantLevel::curve_res, {1, 64, ""}, "segments of a stem"},
    {"curve", &PlantLevel::curve, {-1000, 1000, "deg"}, "bend over the whole stem; negative: upwards"},
    {"curve_back", &PlantLevel::curve_back, {-1000, 1000, "deg"}, "if not 0, bend of the second half, curve the first"},
    {"curve_v", &PlantLevel::curve_v, {-89, 1000, "deg"}, "random bend; negative: a helix at that angle to its axis"},
    {"bend_v", &PlantLevel::bend_v, {0, 1000, "deg"}, "random bend at right angles to it"},
    {"down_angle", &PlantLevel::down_angle, {-180, 180, "deg"}, "from the parent's direction"},
    {"down_angle_v", &PlantLevel::down_angle_v, {-180, 180, "deg"}, "variation; negative: along the parent"},
    {"rotate", &PlantLevel::rotate, {-360, 360, "deg"}, "from child to child around it; negative: side by side"},
    {"rotate_v", &PlantLevel::rotate_v, {0, 360, "deg"}, "variation of it"},
    {"branches", &PlantLevel::branches, {-1000, 1000, ""}, "most stems of this level on one parent; negative: a fan"},
};

std::string schema_of(const LevelField& f, const WeberPennParameters& fallback) {
  std::vector<double> defaults;
  for (const PlantLevel& level : fallback.level) defaults.push_back(level.*f.member);
  return fmt::format(R"({{"type":"array","items":{{"type":["number","null"],"minimum":{},"maximum":{}}},)"
                     R"("minItems":1,"maxItems":{},"default":[{}]}})",
                     f.range.min, f.range.max, plant_level_kinds, fmt::join(defaults, ","));
}

void read_levels(Params& params, const LevelField& f, WeberPennParameters& p) {
  const std::string schema = schema_of(f, p);
  const std::string doc = fmt::format("by level, from the trunk on: {} ({})", f.doc, range_text(f.range));
  const Value* list = params.raw(f.name, false, schema.c_str(), doc.c_str());
  if (!list) return;
  if (list->kind != Value::Kind::Array || list->items.empty() || list->items.size() > plant_level_kinds)
    return params.error(f.name, fmt::format("\"{}\" is a list of 1 to {} numbers, one a level from the trunk on",
                                            f.name, plant_level_kinds));
  for (std::size_t n = 0; n < list->items.size(); ++n) {
    const Value& item = list->items[n];
    if (item.kind == Value::Kind::Null) continue;  // what the species says
    if (item.kind != Value::Kind::Number || !(item.number >= f.range.min && item.number <= f.range.max))
      params.diagnostics().error(
          item.location, fmt::format("\"{}\" of level {}: expected a number, {}", f.name, n, range_text(f.range)));
    else
      p.level[n].*f.member = item.number;
  }
}

// Scalars of the whole tree.
struct TreeField {
  const char* name;
  double WeberPennParameters::*member;
  Range range;
  const char* doc;
};

constexpr TreeField tree_fields[] = {
    {"base_size", &WeberPennParameters::base_size, {0, 0.99, ""}, "bare part of the trunk, in scales"},
    {"scale", &WeberPennParameters::scale, {0.01, 1000, "m"}, "size of the tree"},
    {"scale_v", &WeberPennParameters::scale_v, {0, 1000, "m"}, "variation of it"},
    {"z_scale", &WeberPennParameters::z_scale, {0, 1000, ""}, "in the paper's tables, but in none of its formulas"},
    {"z_scale_v", &WeberPennParameters::z_scale_v, {0, 1000, ""}, "likewise"},
    {"ratio", &WeberPennParameters::ratio, {0.0001, 1, ""}, "radius of the trunk in its lengths"},
    {"ratio_power", &WeberPennParameters::ratio_power, {0, 10, ""}, "by which thinner stems follow from shorter ones"},
    {"lobe_depth", &WeberPennParameters::lobe_depth, {0, 0.9, ""}, "of the trunk's section, in radii"},
    {"flare", &WeberPennParameters::flare, {0, 10, ""}, "widening of the trunk's foot, in radii"},
    {"trunk_scale", &WeberPennParameters::trunk_scale, {0.01, 100, ""}, "more radius for the trunk (0Scale)"},
    {"trunk_scale_v", &WeberPennParameters::trunk_scale_v, {0, 100, ""}, "variation of it"},
    {"leaves", &WeberPennParameters::leaves, {-1000, 1000, ""}, "on a stem of the last level; negative: a fan"},
    {"leaf_scale", &WeberPennParameters::leaf_scale, {0, 10, "m"}, "length of a leaf"},
    {"leaf_scale_x", &WeberPennParameters::leaf_scale_x, {0, 10, ""}, "its width in lengths"},
    {"leaf_bend", &WeberPennParameters::leaf_bend, {0, 1, ""}, "how far leaves turn to the light"},
    {"attraction_up", &WeberPennParameters::attraction_up, {-10, 10, ""}, "how stems from level 2 on turn upwards"},
    {"prune_ratio", &WeberPennParameters::prune_ratio, {0, 1, ""}, "0: not cut to the envelope; 1: fully"},
    {"prune_width", &WeberPennParameters::prune_width, {0, 10, ""}, "radius of the envelope, in scales"},
    {"prune_width_peak", &WeberPennParameters::prune_width_peak, {0, 1, ""}, "where it is widest, from its bottom"},
    {"prune_power_low", &WeberPennParameters::prune_power_low, {0, 10, ""}, "1 straight, 2 hollow, 0.5 bulging"},
    {"prune_power_high", &WeberPennParameters::prune_power_high, {0, 10, ""}, "the same above the widest place"},
    {"quality", &WeberPennParameters::quality, {0.01, 100, ""}, "multiplies leaves, and makes them smaller"},
};

double checked_leaf_length(const WeberPennParameters& p) { return p.leaf_scale / std::sqrt(p.quality); }

// What the formulas divide by.
void check(Params& params, const WeberPennParameters& p) {
  if (p.scale_v > p.scale)
    params.error("scale_v", fmt::format("\"scale_v\" is {}; at most \"scale\", {}, is possible", p.scale_v, p.scale));
  if (p.level[0].length - p.level[0].length_v <= p.base_size * (p.scale + p.scale_v) / p.scale * 1e-3)
    params.error("length", "the trunk has no length");
  if (!(checked_leaf_length(p) < 100)) params.error("leaf_scale", "the leaves are longer than 100 m");
}

}  // namespace

const std::vector<std::string>& crown_shape_names() {
  static const std::vector<std::string> names{"conical",         "spherical",           "hemispherical",
                                              "cylindrical",     "tapered_cylindrical", "flame",
                                              "inverse_conical", "tend_flame",          "envelope"};
  return names;
}

double shape_ratio(int shape, double r) {
  r = std::clamp(r, 0.0, 1.0);
  const double flame = r <= 0.7 ? r / 0.7 : (1 - r) / 0.3;
  switch (shape) {
    case 0: return 0.2 + 0.8 * r;
    case 1: return 0.2 + 0.8 * std::sin(pi * r);
    case 2: return 0.2 + 0.8 * std::sin(0.5 * pi * r);
    case 3: return 1;
    case 4: return 0.5 + 0.5 * r;
    case 5: return flame;
    case 6: return 1 - 0.8 * r;
    default: return 0.5 + 0.5 * flame;
  }
}

double prune_shape_ratio(const WeberPennParameters& p, double r) {
  const double peak = p.prune_width_peak;
  if (!(r >= 0 && r <= 1)) return 0;
  if (r < 1 - peak) return std::pow(r / (1 - peak), p.prune_power_high);
  return peak > 0 ? std::pow((1 - r) / peak, p.prune_power_low) : 1;
}

double crown_shape_ratio(const WeberPennParameters& p, double r) {
  return p.shape == 8 ? prune_shape_ratio(p, std::clamp(r, 0.0, 1.0)) : shape_ratio(p.shape, r);
}

double tapered_radius(double taper, double length, double radius, double z) {
  const double unit_taper = taper < 1 ? taper : taper < 2 ? 2 - taper : 0;
  const double t = radius * (1 - unit_taper * z);
  if (taper < 1) return t;
  const double z2 = (1 - z) * length;
  const double depth = taper < 2 || z2 < t ? 1 : taper - 2;
  const double z3 = taper < 2 || t <= 0 ? z2 : std::abs(z2 - 2 * t * std::floor(z2 / (2 * t) + 0.5));
  if (taper < 2 && z3 >= t) return t;
  return (1 - depth) * t + depth * std::sqrt(std::max(t * t - (z3 - t) * (z3 - t), 0.0));
}

WeberPennParameters read_weber_penn(Params& params) {
  std::vector<std::string> names;
  for (const PlantSpecies& s : plant_species()) names.push_back(s.name);
  const int species = params.choice("species", 0, names, "whose values stand where the scene says nothing else");
  WeberPennParameters p = plant_species()[std::size_t(species)].parameters;
  p.shape = params.choice("shape", p.shape, crown_shape_names(), "of the crown: how long branches are by height");
  p.levels = params.integer("levels", p.levels, {1, most_stem_levels, ""}, "of stems, the trunk included");
  p.lobes = params.integer("lobes", p.lobes, {0, 100, ""}, "bulges around the trunk");
  p.base_splits = params.integer("base_splits", p.base_splits, {0, 5, ""}, "clones above the trunk's first segment");
  for (const TreeField& f : tree_fields) p.*f.member = params.real(f.name, p.*f.member, f.range, f.doc);
  p.leaf_shape = params.choice("leaf_shape", p.leaf_shape, leaf_shape_names(), "outline of a leaf");
  for (const LevelField& f : level_fields) read_levels(params, f, p);
  for (PlantLevel& level : p.level) level.curve_res = std::floor(level.curve_res);
  check(params, p);
  return p;
}

}  // namespace meristem
