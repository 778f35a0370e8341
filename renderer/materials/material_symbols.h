// The variables that material expressions see, and material parameters that are such expressions.
//
//   u, v       texture coordinates             P   position, world space, metres
//   N          shading normal, unit            I   direction the surface is looked at along (towards it), unit
//   p0 .. p7   parameters of the symbol that the face had when growth made it
//   key        a random number in [0, 1) of that face; rand() gives more of them
//
// A material may add textures of its own. Immutable after construction; any thread. A parameter that is constant costs
// nothing at a hit.
#pragma once

#include "geometry/fields/expression.h"
#include "renderer/scene/interfaces.h"

#include <array>

namespace meristem {

constexpr int material_symbol_count = 6 + max_growth_parameters;
constexpr int max_textures = 8;  // of one material; their colours follow (material_textures.h)

const Symbols& material_symbols();

// The values of the symbols at one hit, as expressions take them.
struct MaterialValues {
  explicit MaterialValues(const ShadingPoint& point);
  std::array<Vec3f, material_symbol_count + max_textures> values;
  int count = material_symbol_count;  // of the values that there are
  Key key = 0;                        // of the grown face

  float scalar(const Expression& e) const { return e.evaluate_scalar(used(), key); }
  Vec3f vector(const Expression& e) const { return e.evaluate_vector(used(), key); }

 private:
  std::span<const Vec3f> used() const { return {values.data(), std::size_t(count)}; }
};

// Whether an expression over symbols that begin with these asks for u or v.
bool reads_uv(const Expression& e);

// How texture coordinates change along a step on the tangent plane.
Vec2f uv_step(const SurfaceHit& hit, Vec3f by);

// A scalar parameter, clamped to a range. What is not a number becomes the range's lower end.
class ScalarParameter {
 public:
  ScalarParameter(Params& params, const Symbols& symbols, const char* name, const char* fallback, float lower,
                  float upper, const char* doc);
  ScalarParameter(Params& params, const char* name, const char* fallback, float lower, float upper, const char* doc)
      : ScalarParameter(params, material_symbols(), name, fallback, lower, upper, doc) {}
  float at(const MaterialValues& values) const { return constant_ ? value_ : clean(values.scalar(*expression_)); }
  bool is_constant() const { return constant_; }
  float constant_value() const { return value_; }  // of one that is
  bool reads_uv() const { return meristem::reads_uv(*expression_); }

 private:
  float clean(float x) const { return x > lower_ ? std::min(x, upper_) : lower_; }

  std::shared_ptr<const Expression> expression_;
  float lower_, upper_;
  bool constant_;
  float value_ = 0;
};

// A colour parameter; each channel clamped as a scalar is.
class ColorParameter {
 public:
  ColorParameter(Params& params, const Symbols& symbols, const char* name, const char* fallback, float upper,
                 const char* doc);
  ColorParameter(Params& params, const char* name, const char* fallback, float upper, const char* doc)
      : ColorParameter(params, material_symbols(), name, fallback, upper, doc) {}
  Spectrum at(const MaterialValues& values) const { return constant_ ? value_ : clean(values.vector(*expression_)); }
  bool is_constant() const { return constant_; }
  bool reads_uv() const { return meristem::reads_uv(*expression_); }

 private:
  Spectrum clean(Vec3f c) const;

  std::shared_ptr<const Expression> expression_;
  float upper_;
  bool constant_;
  Spectrum value_;
};

}  // namespace meristem
