// The variables that the expressions of a production see: the parameters of its symbol by name, and the replaced face:
//
//   level                      0 in the first step of the entry that says "grow", 1 in the second, ...
//   up                         cosine between the face's outward normal and the world's up (y): 1 for a face that looks
//   up frame_x, frame_y, frame_z  the axes of the face's reference frame (the paper's figure 7), unit, in model space
//   P                          its centroid, in model space
//   radius                     the mean distance of its corners from the centroid
//   u, v                       texture coordinates at the centroid
//   light                      the direction of light that the entry says, unit, in model space
//   neighbors                  how many of the face's edges it shares with a face whose symbol has rules in the entry
//
// rand() is a hash of the face's key, the step, the production and the parameter that asks.
#pragma once

#include "geometry/cells/step.h"
#include "geometry/fields/expression.h"
#include "geometry/mesh/mesh.h"

#include <array>
#include <string>
#include <vector>

namespace meristem {

// The one whose value needs the faces around.
constexpr const char* neighbors_variable = "neighbors";

constexpr int frame_variable_count = 11;
constexpr int max_rule_variables = max_growth_parameters + frame_variable_count;

// Is `name` one of the variables above (so that no parameter may have it)?
bool is_frame_variable(const std::string& name);

// Slots: the parameters in their order, then the variables above in their order.
Symbols rule_variables(const std::vector<std::string>& parameters);

// The values, or their intervals, of all slots; parameter_count entries first. Only the first parameter_count +
// frame_variable_count entries are set.
using RuleValues = std::array<Vec3f, max_rule_variables>;
using RuleIntervals = std::array<IntervalValue, max_rule_variables>;

// What the variables tell beyond the face itself.
struct RuleSurroundings {
  int level = 0;
  Vec3f light{0, 1, 0};
  int neighbors = 0;
};
constexpr int most_neighbors = 255;  // more are not counted

RuleValues rule_values(const FaceOrigin& origin, int parameter_count, const RuleSurroundings& around,
                       const FaceFrame& frame, Vec2d center_uv);
// For any number of neighbours.
RuleIntervals rule_intervals(const SymbolRange& range, int parameter_count, const RuleSurroundings& around,
                             const Extent& extent);

}  // namespace meristem
