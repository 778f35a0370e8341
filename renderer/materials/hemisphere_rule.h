// Means over the hemisphere of what depends on a direction's cosine c alone, weighted by 2 c: Gauss's rule over the
// root of c, in which albedos are smooth. For what layers let pass to a diffuse base and back.
#pragma once

#include <array>
#include <cstddef>

namespace meristem::hemisphere_rule {

constexpr std::size_t count = 8;
using Values = std::array<float, count>;  // at those roots

constexpr std::array<double, count> roots{0.0990017577, 0.221243507, 0.3691239,   0.528545431,
                                          0.683993248,  0.82028395,  0.924093713, 0.98529344};
constexpr Values weights{4.09840312e-4f, 5.94273633e-3f, 0.0314202954f, 0.0945263227f,
                         0.189817519f,   0.269447358f,   0.264728141f,  0.143707787f};

// In four sums, which are one vector.
inline float dot(const Values& a, const Values& b) {
  std::array<float, 4> sums{};
  for (std::size_t i = 0; i < count; ++i) sums[i % 4] += a[i] * b[i];
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}
inline float mean(const Values& values) { return dot(weights, values); }

// The same of a table, linear between its values at even steps of the root.
template <std::size_t size>
Values of_table(const std::array<float, size>& table) {
  Values values{};
  for (std::size_t i = 0; i < count; ++i) {
    const double at = roots[i] * double(size - 1);
    const auto below = std::size_t(at);
    values[i] = float(table[below] + (table[below + 1] - table[below]) * (at - double(below)));
  }
  return values;
}

}  // namespace meristem::hemisphere_rule
