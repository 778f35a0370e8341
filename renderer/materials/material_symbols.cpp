#include "renderer/materials/material_symbols.h"

#include "geometry/base/check.h"

#include <algorithm>

namespace meristem {

namespace {

constexpr std::array<Vec3f, material_symbol_count + max_textures> no_values{};

}  // namespace

// The order here is that of MaterialValues.
const Symbols& material_symbols() {
  static const Symbols symbols = [] {
    Symbols s;
    s.add("u", ValueType::Scalar, "texture coordinate");
    s.add("v", ValueType::Scalar, "texture coordinate");
    s.add("P", ValueType::Vector, "position, world space, metres");
    s.add("N", ValueType::Vector, "shading normal, unit");
    s.add("I", ValueType::Vector, "direction of view, towards the surface, unit");
    s.add("key", ValueType::Scalar, "random number in [0, 1) of the grown face");
    for (int i = 0; i < max_growth_parameters; ++i)
      s.add("p" + std::to_string(i), ValueType::Scalar, "parameter of the grown face's symbol");
    return s;
  }();
  return symbols;
}

MaterialValues::MaterialValues(const ShadingPoint& point) {
  const SurfaceHit& hit = point.hit;
  key = hit.origin.key;
  const Vec3f key_value(uniform_float(scramble(key)));
  const std::array<Vec3f, 6> first{Vec3f(hit.u), Vec3f(hit.v), hit.position, hit.shading_normal, -point.wo, key_value};
  std::copy(first.begin(), first.end(), values.begin());
  for (int i = 0; i < max_growth_parameters; ++i)
    values[std::size_t(6 + i)] = Vec3f(hit.origin.parameters[std::size_t(i)]);
}

bool reads_uv(const Expression& e) {
  static const int u = material_symbols().find("u"), v = material_symbols().find("v");
  return e.uses(u) || e.uses(v);
}

Vec2f uv_step(const SurfaceHit& hit, Vec3f by) {
  const Vec3f du = hit.dpdu, dv = hit.dpdv;
  const float uu = length_squared(du), uv = dot(du, dv), vv = length_squared(dv), determinant = uu * vv - uv * uv;
  if (!(determinant > 0)) return {};
  return {(dot(by, du) * vv - dot(by, dv) * uv) / determinant, (dot(by, dv) * uu - dot(by, du) * uv) / determinant};
}

ScalarParameter::ScalarParameter(Params& params, const Symbols& symbols, const char* name, const char* fallback,
                                 float lower, float upper, const char* doc)
    : expression_(params.scalar_expression(name, fallback, symbols, doc)), lower_(lower), upper_(upper) {
  CHECK(expression_, "no expression for \"{}\"", name);
  constant_ = expression_->is_constant();
  if (constant_) value_ = clean(expression_->evaluate_scalar(no_values));
}

ColorParameter::ColorParameter(Params& params, const Symbols& symbols, const char* name, const char* fallback,
                               float upper, const char* doc)
    : expression_(params.vector_expression(name, fallback, symbols, doc)), upper_(upper) {
  CHECK(expression_, "no expression for \"{}\"", name);
  constant_ = expression_->is_constant();
  if (constant_) value_ = clean(expression_->evaluate_vector(no_values));
}

Spectrum ColorParameter::clean(Vec3f c) const {
  auto channel = [&](float x) { return x > 0 ? std::min(x, upper_) : 0.f; };
  return {channel(c.x), channel(c.y), channel(c.z)};
}

}  // namespace meristem
