// The published species: the appendix of Weber and Penn 1995, figure by figure, and some of our own. bend_v and
// leaf_bend are not in the paper's tables: the first is ours, so that stems do not bend in one plane alone, the second
// has the value of the text's pictures.
#include "procedural/plants/weber_penn_parameters.h"

namespace meristem {

namespace {

WeberPennParameters quaking_aspen() {
  WeberPennParameters p;
  p.shape = 7, p.base_size = 0.4, p.levels = 3;
  p.scale = 13, p.scale_v = 3;
  p.ratio = 0.015, p.ratio_power = 1.2;
  p.lobes = 5, p.lobe_depth = 0.07, p.flare = 0.6;
  p.level[0] = {.length = 1, .taper = 1, .curve_res = 3, .curve_v = 20, .bend_v = 10};
  p.level[1] = {.length = 0.3,
                .taper = 1,
                .curve_res = 5,
                .curve = -40,
                .curve_v = 50,
                .bend_v = 25,
                .down_angle = 60,
                .down_angle_v = -50,
                .rotate = 140,
                .branches = 50};
  p.level[2] = {.length = 0.6,
                .taper = 1,
                .curve_res = 3,
                .curve = -40,
                .curve_v = 75,
                .bend_v = 35,
                .down_angle = 45,
                .down_angle_v = 10,
                .rotate = 140,
                .branches = 30};
  p.level[3] = {
      .length = 0, .taper = 1, .curve_res = 1, .down_angle = 45, .down_angle_v = 10, .rotate = 77, .branches = 10};
  p.leaves = 25, p.leaf_shape = 0, p.leaf_scale = 0.17, p.leaf_scale_x = 1;
  p.attraction_up = 0.5;
  return p;
}

WeberPennParameters black_tupelo() {
  WeberPennParameters p;
  p.shape = 4, p.base_size = 0.2, p.levels = 4;
  p.scale = 23, p.scale_v = 5;
  p.ratio = 0.015, p.ratio_power = 1.3;
  p.lobes = 3, p.lobe_depth = 0.1, p.flare = 1;
  p.level[0] = {.length = 1, .taper = 1.1, .curve_res = 10, .curve_v = 40, .bend_v = 20};
  p.level[1] = {.length = 0.3,
                .length_v = 0.05,
                .taper = 1,
                .curve_res = 10,
                .curve_v = 90,
                .bend_v = 40,
                .down_angle = 60,
                .down_angle_v = -40,
                .rotate = 140,
                .branches = 50};
  p.level[2] = {.length = 0.6,
                .length_v = 0.1,
                .taper = 1,
                .curve_res = 10,
                .curve = -10,
                .curve_v = 150,
                .bend_v = 60,
                .down_angle = 30,
                .down_angle_v = 10,
                .rotate = 140,
                .branches = 25};
  p.level[3] = {
      .length = 0.4, .taper = 1, .curve_res = 1, .down_angle = 45, .down_angle_v = 10, .rotate = 140, .branches = 12};
  p.leaves = 6, p.leaf_shape = 0, p.leaf_scale = 0.3, p.leaf_scale_x = 0.5;
  p.attraction_up = 0.5;
  return p;
}

WeberPennParameters weeping_willow() {
  WeberPennParameters p;
  p.shape = 3, p.base_size = 0.05, p.levels = 4;
  p.scale = 15, p.scale_v = 5;
  p.ratio = 0.03, p.ratio_power = 2;
  p.lobes = 9, p.lobe_depth = 0.03, p.flare = 0.75;
  p.base_splits = 2;
  p.level[0] = {.length = 0.8,
                .taper = 1,
                .seg_splits = 0.1,
                .split_angle = 3,
                .curve_res = 8,
                .curve_back = 20,
                .curve_v = 120,
                .bend_v = 40};
  p.level[1] = {.length = 0.5,
                .length_v = 0.1,
                .taper = 1,
                .seg_splits = 0.2,
                .split_angle = 30,
                .split_angle_v = 10,
                .curve_res = 16,
                .curve = 40,
                .curve_back = 80,
                .curve_v = 90,
                .bend_v = 45,
                .down_angle = 20,
                .down_angle_v = 10,
                .rotate = -120,
                .rotate_v = 30,
                .branches = 25};
  p.level[2] = {.length = 1.5,
                .taper = 1,
                .seg_splits = 0.2,
                .split_angle = 45,
                .split_angle_v = 20,
                .curve_res = 12,
                .down_angle = 30,
                .down_angle_v = 10,
                .rotate = -120,
                .rotate_v = 30,
                .branches = 10};
  p.level[3] = {
      .length = 0.1, .taper = 1, .curve_res = 1, .down_angle = 20, .down_angle_v = 10, .rotate = 140, .branches = 300};
  p.leaves = 15, p.leaf_shape = 0, p.leaf_scale = 0.12, p.leaf_scale_x = 0.2;
  p.attraction_up = -3;
  p.prune_ratio = 1, p.prune_width = 0.4, p.prune_width_peak = 0.6, p.prune_power_low = 0.001, p.prune_power_high = 0.5;
  return p;
}

WeberPennParameters california_black_oak() {
  WeberPennParameters p;
  p.shape = 2, p.base_size = 0.05, p.levels = 3;
  p.scale = 10, p.scale_v = 10;
  p.ratio = 0.018, p.ratio_power = 1.3;
  p.lobes = 5, p.lobe_depth = 0.1, p.flare = 1.2;
  p.base_splits = 2;
  p.level[0] = {
      .length = 1, .taper = 0.95, .seg_splits = 0.4, .split_angle = 10, .curve_res = 8, .curve_v = 90, .bend_v = 30};
  p.level[1] = {.length = 0.8,
                .length_v = 0.1,
                .taper = 1,
                .seg_splits = 0.2,
                .split_angle = 10,
                .split_angle_v = 10,
                .curve_res = 10,
                .curve = 40,
                .curve_back = -70,
                .curve_v = 150,
                .bend_v = 60,
                .down_angle = 30,
                .down_angle_v = -30,
                .rotate = 80,
                .branches = 40};
  p.level[2] = {.length = 0.2,
                .length_v = 0.05,
                .taper = 1,
                .seg_splits = 0.1,
                .split_angle = 10,
                .split_angle_v = 10,
                .curve_res = 3,
                .curve_v = -30,
                .down_angle = 45,
                .down_angle_v = 10,
                .rotate = 140,
                .branches = 120};
  p.level[3] = {.length = 0.4, .taper = 1, .curve_res = 1, .down_angle = 45, .down_angle_v = 10, .rotate = 140};
  p.leaves = 25, p.leaf_shape = 0, p.leaf_scale = 0.12, p.leaf_scale_x = 0.66;
  p.attraction_up = 0.8;
  return p;
}

// Those below are our own, by eye.

WeberPennParameters norway_spruce() {
  WeberPennParameters p;
  p.shape = 0, p.base_size = 0.06, p.levels = 3;
  p.scale = 22, p.scale_v = 4;
  p.ratio = 0.015, p.ratio_power = 1.1;
  p.lobes = 3, p.lobe_depth = 0.05, p.flare = 0.6;
  p.level[0] = {.length = 1, .taper = 1, .curve_res = 6, .curve_v = 8, .bend_v = 8};
  p.level[1] = {.length = 0.24,
                .length_v = 0.02,
                .taper = 1,
                .curve_res = 5,
                .curve = -45,
                .curve_v = 25,
                .bend_v = 15,
                .down_angle = 85,
                .down_angle_v = -32,
                .rotate = 140,
                .rotate_v = 12,
                .branches = 160};
  p.level[2] = {.length = 0.34,
                .length_v = 0.06,
                .taper = 1,
                .curve_res = 3,
                .curve = 15,
                .curve_v = 20,
                .bend_v = 15,
                .down_angle = 58,
                .down_angle_v = 8,
                .rotate = -100,
                .rotate_v = 14,
                .branches = 44};
  p.level[3] = {.length = 0, .curve_res = 1, .down_angle = 50, .down_angle_v = 12, .rotate = 140, .branches = 0};
  p.leaves = 56, p.leaf_shape = 6, p.leaf_scale = 0.1, p.leaf_scale_x = 0.18, p.leaf_bend = 0;
  p.attraction_up = -0.3;
  return p;
}

WeberPennParameters lombardy_poplar() {
  WeberPennParameters p;
  p.shape = 5, p.base_size = 0.03, p.levels = 3;
  p.scale = 24, p.scale_v = 3;
  p.ratio = 0.014, p.ratio_power = 1.3;
  p.lobes = 5, p.lobe_depth = 0.08, p.flare = 0.8;
  p.level[0] = {.length = 1, .taper = 1, .curve_res = 6, .curve_v = 15, .bend_v = 10};
  p.level[1] = {.length = 0.26,
                .length_v = 0.04,
                .taper = 1,
                .curve_res = 5,
                .curve = -16,
                .curve_v = 30,
                .bend_v = 15,
                .down_angle = 30,
                .down_angle_v = -8,
                .rotate = 140,
                .rotate_v = 20,
                .branches = 75};
  p.level[2] = {.length = 0.4,
                .length_v = 0.05,
                .taper = 1,
                .curve_res = 3,
                .curve = -20,
                .curve_v = 40,
                .bend_v = 20,
                .down_angle = 35,
                .down_angle_v = 10,
                .rotate = 140,
                .rotate_v = 20,
                .branches = 30};
  p.level[3] = {.length = 0, .curve_res = 1, .down_angle = 50, .down_angle_v = 15, .rotate = 140, .branches = 0};
  p.leaves = 30, p.leaf_shape = 1, p.leaf_scale = 0.12, p.leaf_scale_x = 0.95;
  p.attraction_up = 1;
  return p;
}

WeberPennParameters silver_birch() {
  WeberPennParameters p;
  p.shape = 7, p.base_size = 0.2, p.levels = 3;
  p.scale = 17, p.scale_v = 3;
  p.ratio = 0.012, p.ratio_power = 1.4;
  p.lobes = 4, p.lobe_depth = 0.04, p.flare = 0.5;
  p.level[0] = {.length = 1, .taper = 1, .curve_res = 8, .curve_v = 40, .bend_v = 25};
  p.level[1] = {.length = 0.36,
                .length_v = 0.05,
                .taper = 1,
                .seg_splits = 0.1,
                .split_angle = 25,
                .split_angle_v = 10,
                .curve_res = 8,
                .curve = -40,
                .curve_back = 70,
                .curve_v = 60,
                .bend_v = 40,
                .down_angle = 52,
                .down_angle_v = -25,
                .rotate = 140,
                .rotate_v = 25,
                .branches = 38};
  p.level[2] = {.length = 0.45,
                .length_v = 0.1,
                .taper = 1,
                .curve_res = 5,
                .curve_v = 30,
                .bend_v = 20,
                .down_angle = 55,
                .down_angle_v = 15,
                .rotate = 140,
                .rotate_v = 25,
                .branches = 42};
  p.level[3] = {.length = 0, .curve_res = 1, .down_angle = 55, .down_angle_v = 20, .rotate = 140, .branches = 0};
  p.leaves = 40, p.leaf_shape = 1, p.leaf_scale = 0.095, p.leaf_scale_x = 0.75;
  p.attraction_up = -2.2;
  return p;
}

}  // namespace

std::span<const PlantSpecies> plant_species() {
  static const PlantSpecies species[] = {
      {"quaking_aspen", "Populus tremuloides, 13 m", quaking_aspen()},
      {"black_tupelo", "Nyssa sylvatica, 23 m", black_tupelo()},
      {"weeping_willow", "Salix babylonica, 15 m", weeping_willow()},
      {"california_black_oak", "Quercus kelloggii, 10 m", california_black_oak()},
      {"norway_spruce", "Picea abies, 22 m", norway_spruce()},
      {"lombardy_poplar", "Populus nigra 'Italica', 24 m", lombardy_poplar()},
      {"silver_birch", "Betula pendula, 17 m", silver_birch()},
  };
  return species;
}

}  // namespace meristem
