#include "procedural/growth/rule_variables.h"

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

struct FrameVariable {
  const char* name;
  ValueType type;
  const char* doc;
};

constexpr std::array<FrameVariable, frame_variable_count> frame_variables{{
    {"level", ValueType::Scalar, "0 in the first growing step, 1 in the second"},
    {"up", ValueType::Scalar, "cosine between the face's normal and the world's up"},
    {"frame_x", ValueType::Vector, "the face's reference direction, unit"},
    {"frame_y", ValueType::Vector, "frame_z cross frame_x"},
    {"frame_z", ValueType::Vector, "the face's outward normal, unit"},
    {"P", ValueType::Vector, "the face's centroid"},
    {"radius", ValueType::Scalar, "mean distance of the face's corners from its centroid"},
    {"u", ValueType::Scalar, "texture coordinate at the centroid"},
    {"v", ValueType::Scalar, "texture coordinate at the centroid"},
    {"light", ValueType::Vector, "direction of light that the entry says, unit"},
    {neighbors_variable, ValueType::Scalar, "edges shared with faces whose symbols have rules"},
}};

// A float interval that holds a double interval after rounding to float, in whatever direction.
Interval widened(double lower, double upper) {
  return {std::nextafterf(float(lower), -INFINITY), std::nextafterf(float(upper), INFINITY)};
}

IntervalValue scalar(Interval i) { return IntervalValue::scalar(i.lower, i.upper); }

// Rounding may leave a component or the length of a unit vector a little above 1.
IntervalValue nearly_unit_vector() {
  constexpr float one = 1.000001f;
  return {{-one, one}, {-one, one}, {-one, one}, one};
}

}  // namespace

bool is_frame_variable(const std::string& name) {
  for (const FrameVariable& v : frame_variables)
    if (name == v.name) return true;
  return false;
}

Symbols rule_variables(const std::vector<std::string>& parameters) {
  Symbols symbols;
  for (const std::string& p : parameters) symbols.add(p, ValueType::Scalar, "parameter of the symbol");
  for (const FrameVariable& v : frame_variables) symbols.add(v.name, v.type, v.doc);
  return symbols;
}

RuleValues rule_values(const FaceOrigin& origin, int parameter_count, const RuleSurroundings& around,
                       const FaceFrame& frame, Vec2d center_uv) {
  RuleValues values;
  std::size_t i = 0;
  for (; i < std::size_t(parameter_count); ++i) values[i] = {origin.parameters[i], 0, 0};
  values[i++] = {float(around.level), 0, 0};
  values[i++] = {float(frame.z.y), 0, 0};
  values[i++] = Vec3f(frame.x);
  values[i++] = Vec3f(frame.y);
  values[i++] = Vec3f(frame.z);
  values[i++] = Vec3f(frame.origin);
  values[i++] = {float(frame.radius), 0, 0};
  values[i++] = {float(center_uv.x), 0, 0};
  values[i++] = {float(center_uv.y), 0, 0};
  values[i++] = around.light;
  values[i++] = {float(std::min(around.neighbors, most_neighbors)), 0, 0};
  return values;
}

RuleIntervals rule_intervals(const SymbolRange& range, int parameter_count, const RuleSurroundings& around,
                             const Extent& extent) {
  RuleIntervals values;
  std::size_t i = 0;
  for (; i < std::size_t(parameter_count); ++i) values[i] = scalar(range.parameters[i]);
  values[i++] = IntervalValue::scalar(float(around.level), float(around.level));
  values[i++] = IntervalValue::scalar(-1.000001f, 1.000001f);
  for (int axis = 0; axis < 3; ++axis) values[i++] = nearly_unit_vector();
  // The centroid of a face in the box may round out of it by an ulp or two
  const Vec3d slack = max(abs(extent.box.lower), abs(extent.box.upper)) * 1e-12;
  const Bounds3d box = extent.box.inflated(slack);
  IntervalValue p;
  p.x = widened(box.lower.x, box.upper.x);
  p.y = widened(box.lower.y, box.upper.y);
  p.z = widened(box.lower.z, box.upper.z);
  values[i++] = p;
  values[i++] = scalar(widened(0, double(range.radius) * (1 + 1e-12)));
  for (const Interval& c : {extent.u, extent.v}) {
    const double margin = 1e-9 * std::max(std::abs(c.lower), std::abs(c.upper));
    values[i++] = scalar(widened(double(c.lower) - margin, double(c.upper) + margin));
  }
  const Vec3f l = around.light;
  values[i++] = {{l.x, l.x}, {l.y, l.y}, {l.z, l.z}, 1.000001f};
  values[i++] = IntervalValue::scalar(0, float(most_neighbors));
  return values;
}

}  // namespace meristem
