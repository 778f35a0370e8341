#include "procedural/growth/template.h"

#include "geometry/base/check.h"

#include <cmath>

namespace meristem {

namespace {

// Numbers beyond this make no geometry that a grid could hold, so infinite ranges end here.
constexpr double largest_number = 1e9;

double clamped(double x, const Range& range) {
  const double low = std::max(range.min, -largest_number), high = std::min(range.max, largest_number);
  return std::clamp(std::isnan(x) ? 0.0 : x, low, high);
}

Vec3d clamped(Vec3d v, const Range& range) { return {clamped(v.x, range), clamped(v.y, range), clamped(v.z, range)}; }

Vec3d lower_of(const IntervalValue& i) { return {i.x.lower, i.y.lower, i.z.lower}; }
Vec3d upper_of(const IntervalValue& i) { return {i.x.upper, i.y.upper, i.z.upper}; }

}  // namespace

Vec3d TemplateParameter::evaluate(std::span<const Vec3f> variables, Key key, Key salt) const {
  if (expression->type() == ValueType::Scalar)
    return {clamped(expression->evaluate_scalar(variables, key, salt), range), 0, 0};
  return clamped(Vec3d(expression->evaluate_vector(variables, key, salt)), range);
}

Bounds3d TemplateParameter::bounds(std::span<const IntervalValue> variables) const {
  const IntervalValue i = expression->evaluate_bounds(variables);
  Bounds3d b;
  b.extend(clamped(lower_of(i), range));
  b.extend(clamped(upper_of(i), range));
  b.extend(clamped(Vec3d{}, range));  // what is not a number becomes this
  return b;
}

int TemplateParams::number(const char* name, const char* fallback, Range range, const char* doc) {
  parameters_.push_back({params_.scalar_expression(name, fallback, variables_, doc), range});
  return int(parameters_.size()) - 1;
}

int TemplateParams::vector(const char* name, const char* fallback, Range range, const char* doc) {
  parameters_.push_back({params_.vector_expression(name, fallback, variables_, doc), range});
  return int(parameters_.size()) - 1;
}

std::vector<std::string> TemplateRegistry::names() const {
  std::vector<std::string> result;
  for (const Entry& e : entries_) result.push_back(e.name);
  return result;
}

std::vector<ComponentInfo> TemplateRegistry::infos() const {
  std::vector<ComponentInfo> result;
  for (const Entry& e : entries_)
    result.push_back({"template", e.name, e.doc, [make = e.make] {
                        std::vector<ParamInfo> infos;
                        Params params(infos);
                        const Symbols variables;
                        const TemplateFiles files;
                        TemplateParams template_params(params, variables, files);
                        make(template_params);
                        return infos;
                      }});
  return result;
}

BoundTemplate TemplateRegistry::create(const std::string& name, Params& params, const Symbols& variables,
                                       const TemplateFiles& files) const {
  for (const Entry& e : entries_) {
    if (e.name != name) continue;
    TemplateParams template_params(params, variables, files);
    BoundTemplate result{e.make(template_params), {}};
    result.parameters = template_params.take();
    return result;
  }
  CHECK(false, "no template is named {}", name);
}

NamedFaces sample_growth(const BoundTemplate& part, std::uint32_t corners) {
  std::vector<Vec3d> values, positions;
  for (const TemplateParameter& p : part.parameters) values.push_back(clamped(Vec3d(1.0), p.range));
  for (std::uint32_t i = 0; i < corners; ++i) {
    const double angle = 2 * pi * i / corners;
    positions.push_back({std::cos(angle), std::sin(angle), 0});
  }
  const std::vector<Vec2d> uv(corners);
  const Vec3d x = normalize(positions[0] + positions[1]), z{0, 0, 1};
  NamedFaces faces;
  faces.clear(corners);
  part.shape->grow({positions, uv, {{}, x, cross(z, x), z, 1}, values}, faces);
  return faces;
}

}  // namespace meristem
