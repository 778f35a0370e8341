// What the tests of the expression language share: variables, and ways to evaluate.
#pragma once

#include "geometry/fields/expression.h"
#include "geometry/fields/parser.h"
#include "geometry/fields/program.h"

#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace meristem::test {

// x, y, z: scalars; P, N: vectors.
inline const Symbols& variables() {
  static const Symbols symbols = [] {
    Symbols s;
    for (const char* name : {"x", "y", "z"}) s.add(name, ValueType::Scalar);
    for (const char* name : {"P", "N"}) s.add(name, ValueType::Vector);
    return s;
  }();
  return symbols;
}
constexpr int slot_count = 5;

using Values = std::array<Vec3f, slot_count>;

inline float value(const std::string& text, const Values& values = {}, Key key = 0, Key salt = 0) {
  return Expression::compile(text, variables(), ValueType::Scalar)->evaluate_scalar(values, key, salt);
}
inline Vec3f vector_value(const std::string& text, const Values& values = {}, Key key = 0, Key salt = 0) {
  return Expression::compile(text, variables(), ValueType::Vector)->evaluate_vector(values, key, salt);
}

// Arrays of values for all variables.
struct Points {
  explicit Points(std::size_t count, unsigned seed = 1, float range = 10) : columns(slot_count), keys(count) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(-range, range);
    for (auto& column : columns)
      for (auto& component : column) {
        component.resize(count);
        for (float& v : component) v = uniform(random);
      }
    for (Key& k : keys) k = hash_keys(random(), random());
  }
  std::vector<Input> inputs(std::size_t start = 0) const {
    std::vector<Input> list;
    for (const auto& c : columns) list.push_back({c[0].data() + start, c[1].data() + start, c[2].data() + start, 1});
    return list;
  }
  Values at(std::size_t i) const {
    Values v;
    for (std::size_t s = 0; s < slot_count; ++s) v[s] = {columns[s][0][i], columns[s][1][i], columns[s][2][i]};
    return v;
  }
  std::size_t size() const { return keys.size(); }

  std::vector<std::array<std::vector<float>, 3>> columns;
  std::vector<Key> keys;
};

using Results = std::array<std::vector<float>, 3>;

inline Results evaluate(const Expression& e, const Points& points, Key salt = 0) {
  Results r;
  for (auto& c : r) c.resize(points.size());
  const auto inputs = points.inputs();
  e.evaluate({int(points.size()), inputs, points.keys.data(), salt}, r[0].data(), r[1].data(), r[2].data());
  return r;
}
inline Results evaluate(const std::string& text, const Points& points, ValueType type = ValueType::Vector) {
  return evaluate(*Expression::compile(text, variables(), type), points);
}

// Expressions that together use every operation, over the variables above.
inline const std::vector<std::string>& all_operations() {
  static const std::vector<std::string> texts = {"-x",
                                                 "!x",
                                                 "~x",
                                                 "x + y",
                                                 "x - y",
                                                 "x * y",
                                                 "x / y",
                                                 "x % y",
                                                 "x ^ y",
                                                 "x^2",
                                                 "x^3",
                                                 "x^4",
                                                 "x^0.5",
                                                 "x^-3",
                                                 "x^5",
                                                 "abs(x)^y",
                                                 "x < y",
                                                 "x > y",
                                                 "x <= y",
                                                 "x >= y",
                                                 "x == y",
                                                 "x != y",
                                                 "x && y",
                                                 "x || y",
                                                 "x < y ? x : z",
                                                 "P * x",
                                                 "P + N",
                                                 "P / x",
                                                 "[x, y, z]",
                                                 "P[1]",
                                                 "x < 0 ? P : N",
                                                 "abs(x)",
                                                 "sign(x)",
                                                 "floor(x)",
                                                 "ceil(x)",
                                                 "round(x)",
                                                 "trunc(x)",
                                                 "fmod(x, y)",
                                                 "min(x, y, z)",
                                                 "max(x, y)",
                                                 "clamp(x, -1, 2)",
                                                 "sqrt(x)",
                                                 "cbrt(x)",
                                                 "pow(x, y)",
                                                 "exp(x)",
                                                 "log(x)",
                                                 "log10(x)",
                                                 "hypot(x, y)",
                                                 "invert(x)",
                                                 "sin(x)",
                                                 "cos(x)",
                                                 "tan(x)",
                                                 "asin(x)",
                                                 "acos(x)",
                                                 "atan(x)",
                                                 "atan2(x, y)",
                                                 "sinh(x)",
                                                 "cosh(x)",
                                                 "tanh(x)",
                                                 "asinh(x)",
                                                 "acosh(x)",
                                                 "atanh(x)",
                                                 "atanh(0.01*x)",
                                                 "deg(x)",
                                                 "rad(x)",
                                                 "sind(x)",
                                                 "cosd(x)",
                                                 "tand(x)",
                                                 "asind(x)",
                                                 "acosd(x)",
                                                 "atand(x)",
                                                 "atan2d(x, y)",
                                                 "mix(x, y, z)",
                                                 "mix(P, N, clamp(x, 0, 1))",
                                                 "compress(x, 2, 5)",
                                                 "expand(x, 2, 5)",
                                                 "fit(x, 0, 1, 3, 5)",
                                                 "boxstep(x, y)",
                                                 "linearstep(x, -1, 3)",
                                                 "linearstep(x, y, z)",
                                                 "smoothstep(x, 3, -1)",
                                                 "gaussstep(x, -1, 3)",
                                                 "remap(x, 0, 1, 2, 0)",
                                                 "remap(x, y, 1, 0, 0)",
                                                 "remap(x, y, 1, 2, 1)",
                                                 "remap(x, 0, 1, 2, 2)",
                                                 "gamma(x, y)",
                                                 "bias(x, y)",
                                                 "contrast(x, 0.7)",
                                                 "length(P)",
                                                 "norm(P)",
                                                 "dot(P, N)",
                                                 "dot(P, P)",
                                                 "cross(P, N)",
                                                 "dist(P, N)",
                                                 "angle(P, N)",
                                                 "ortho(P, N)",
                                                 "rotate(P, N, x)",
                                                 "up(P, N)",
                                                 "saturate(P, x)",
                                                 "hsi(P, x, y, z)",
                                                 "hsi(P, 90, 0.5, 2, x)",
                                                 "midhsi(P, x, y, z, 0.2)",
                                                 "midhsi(P, 90, 0.5, 2, x)",
                                                 "midhsi(P, 90, 0.5, 2, x, 0.6, 1)",
                                                 "midhsi(P, x, y, z, x, y, 2)",
                                                 "rgbtohsl(P)",
                                                 "hsltorgb(P)",
                                                 "noise(P)",
                                                 "noise(x, y)",
                                                 "noise(x, y, z, 0.1*x)",
                                                 "noise(0.01*P, y)",
                                                 "snoise(P)",
                                                 "snoise(0.01*x)",
                                                 "snoise4(P, x)",
                                                 "snoise4(0.01*P, 0.02*x)",
                                                 "snoise(x, y, z, 2)",
                                                 "vnoise(P)",
                                                 "cnoise(0.02*P)",
                                                 "vnoise4(P, 0.1*y)",
                                                 "vnoise4(0.03*P, 0.1)",
                                                 "cnoise4(P, z)",
                                                 "pnoise(P, [3, 4, 5])",
                                                 "pnoise(0.01*P, [7, 1, 2])",
                                                 "pnoise(P, N)",
                                                 "pnoise(0.02*P, [x, 4, 2])",
                                                 "fbm(P)",
                                                 "fbm(P/100)",
                                                 "fbm(P, 3, 2.2, 0.6)",
                                                 "fbm(P, 3, x, y)",
                                                 "vfbm(0.01*P, 4)",
                                                 "cfbm(P)",
                                                 "fbm4(P, x)",
                                                 "fbm4(0.01*P, 0.02*x, 4)",
                                                 "fbm4(P, x, 3, y, z)",
                                                 "vfbm4(0.02*P, 0.01*y, 3, 2.2, 0.6)",
                                                 "cfbm4(P, x, 2)",
                                                 "turbulence(0.03*P)",
                                                 "vturbulence(P)",
                                                 "cturbulence(P)",
                                                 "cellnoise(P)",
                                                 "ccellnoise(P)",
                                                 "voronoi(P)",
                                                 "voronoi(P, 2, 1)",
                                                 "voronoi(P, 3, x)",
                                                 "voronoi(P, 4)",
                                                 "voronoi(P, 5)",
                                                 "voronoi(P, 1, 0.5, 0.3)",
                                                 "cvoronoi(P)",
                                                 "pvoronoi(P, 1, 1)",
                                                 "hash(x, P)",
                                                 "rand()",
                                                 "rand(x, y)",
                                                 "rand(0, 1, x) - rand(0, 1, x)",
                                                 "choose(x, y, z, 3)",
                                                 "choose(rand(), P, N)",
                                                 "swatch(x, y, z, 3)",
                                                 "swatch(x, P, N)",
                                                 "wchoose(rand(), x, 1, y, 2, z, y)",
                                                 "pick(rand(), 1, 6)",
                                                 "cycle(x, 2, 5)",
                                                 "curve(x, -1, 0, 1, 0, 2, 2, 1, 1, 3, 3, 5, 4, 5, 1, 0)",
                                                 "ccurve(x, 0, [1,0,0], 1, 1, [0,1,2], 4)",
                                                 "spline(x, 0, 1, -1, 2, 3)",
                                                 "spline(rand(), x, y, z, x)"};
  return texts;
}

}  // namespace meristem::test
