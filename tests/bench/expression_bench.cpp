// What the expression language costs: the bark formula of the paper's example by the block evaluator and by plain C++
// of the same formula, measured in turns so that both meet the same weather; medians.
#include "geometry/fields/parser.h"
#include "geometry/fields/program.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <random>
#include <vector>

using namespace meristem;

namespace {

// The noise of docs/expressions.md as one would write it for a single point.
struct PlainNoise {
  static float corner(std::uint32_t w, float x, float y, float z) {
    const std::uint32_t h = w * w;
    return float(std::int32_t(h)) * x + float(std::int32_t(h << 7)) * y + float(std::int32_t(h << 14)) * z;
  }
  static float fade(float t) { return t * t * t * (t * (t * 6 - 15) + 10); }
  static float lerp(float a, float b, float t) { return a + t * (b - a); }

  static float at(Vec3f p) {
    const float fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
    const float x = p.x - fx, y = p.y - fy, z = p.z - fz;
    const std::uint32_t hx[2] = {std::uint32_t(int(fx)) * 0xd1342543u,
                                 std::uint32_t(int(fx)) * 0xd1342543u + 0xd1342543u};
    const std::uint32_t hy[2] = {std::uint32_t(int(fy)) * 0xde82ef95u,
                                 std::uint32_t(int(fy)) * 0xde82ef95u + 0xde82ef95u};
    const std::uint32_t hz[2] = {std::uint32_t(int(fz)) * 0xa24baed5u,
                                 std::uint32_t(int(fz)) * 0xa24baed5u + 0xa24baed5u};
    const float u = fade(x), v = fade(y), w = fade(z);
    float planes[2];
    for (int k = 0; k < 2; ++k) {
      float rows[2];
      for (int j = 0; j < 2; ++j)
        rows[j] = lerp(corner(hx[0] ^ hy[j] ^ hz[k], x, y - float(j), z - float(k)),
                       corner(hx[1] ^ hy[j] ^ hz[k], x - 1, y - float(j), z - float(k)), u);
      planes[k] = lerp(rows[0], rows[1], v);
    }
    return std::clamp(lerp(planes[0], planes[1], w) * 0x1.4p-31f, -1.0f, 1.0f);
  }
};

float plain_fbm(Vec3f p) {
  float sum = 0, amplitude = 1, shift = 0;
  for (int octave = 0; octave < 6; ++octave) {
    sum += amplitude * PlainNoise::at(p);
    amplitude *= 0.5f;
    p = p * 2.0f;
    shift += 0.61803399f;
    if (shift >= 1) shift -= 1;
    const float t = (p.y + p.z - p.x) * (2.0f / 3) + shift;
    p = {t - p.y, t - p.z, t + p.x};
  }
  return sum;
}

struct Vertices {
  explicit Vertices(std::size_t count) : columns(8, std::vector<float>(count)), out(3, std::vector<float>(count)) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(-1, 1);
    for (auto& c : columns)
      for (float& v : c) v = uniform(random);
  }
  std::vector<std::vector<float>> columns;  // P, N, u, scale
  std::vector<std::vector<float>> out;
};

void plain(Vertices& v) {
  const auto& c = v.columns;
  for (std::size_t i = 0; i < c[0].size(); ++i) {
    const Vec3f p{c[0][i], c[1][i], c[2][i]}, n{c[3][i], c[4][i], c[5][i]};
    const float height = std::abs(std::sin(8 * float(pi) * c[6][i])) + 0.3f * plain_fbm(p * 6.0f);
    const Vec3f d = n * (0.6f * c[7][i] * height);
    for (int k = 0; k < 3; ++k) v.out[std::size_t(k)][i] = d[k];
  }
}

double nanoseconds(const std::function<void()>& work, std::size_t points) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count() / double(points);
}

double median(std::vector<double> v) {
  std::ranges::nth_element(v, v.begin() + std::ptrdiff_t(v.size() / 2));
  return v[v.size() / 2];
}

Symbols bark_symbols() {
  Symbols s;
  s.add("P", ValueType::Vector);
  s.add("N", ValueType::Vector);
  s.add("u", ValueType::Scalar);
  s.add("scale", ValueType::Scalar);
  return s;
}

struct Contender {
  const char* name;
  std::function<void()> work;
  std::vector<double> times;
};

void compare(std::vector<Contender> contenders, std::size_t points, int rounds) {
  for (int r = 0; r < rounds; ++r)
    for (Contender& c : contenders) c.times.push_back(nanoseconds(c.work, points));
  for (Contender& c : contenders)
    std::printf("  %-28s %8.2f ns a point (median), %8.2f (best)\n", c.name, median(c.times),
                *std::ranges::min_element(c.times));
}

void bark() {
  Vertices v(4096);  // about as many as a large cell has
  const Symbols symbols = bark_symbols();
  const auto parsed = parse_expression("0.6*scale*N*(abs(sin(8*PI*u)) + 0.3*fbm(6*P))", symbols, ValueType::Vector);
  const Program program(parsed.graph, parsed.result);
  const auto& c = v.columns;
  const std::vector<Input> inputs{{c[0].data(), c[1].data(), c[2].data(), 1},
                                  {c[3].data(), c[4].data(), c[5].data(), 1},
                                  {c[6].data(), nullptr, nullptr, 1},
                                  {c[7].data(), nullptr, nullptr, 1}};
  auto by = [&](const KernelTable& kernels) {
    return [&] { program.run(kernels, {int(c[0].size()), inputs}, v.out[0].data(), v.out[1].data(), v.out[2].data()); };
  };
  std::printf("0.6*scale*N*(abs(sin(8*PI*u)) + 0.3*fbm(6*P)), %zu vertices\n", c[0].size());
  std::vector<Contender> contenders{{"plain C++", [&] { plain(v); }, {}}};
  for (const KernelTable* kernels : usable_kernels()) contenders.push_back({kernels->name, by(*kernels), {}});
  compare(std::move(contenders), c[0].size(), 101);
}

void single_functions() {
  Vertices v(4096);  // about as many as a large cell has
  const Symbols symbols = bark_symbols();
  const auto& c = v.columns;
  const std::vector<Input> inputs{{c[0].data(), c[1].data(), c[2].data(), 1},
                                  {c[3].data(), c[4].data(), c[5].data(), 1},
                                  {c[6].data(), nullptr, nullptr, 1},
                                  {c[7].data(), nullptr, nullptr, 1}};
  std::printf("single functions, %s\n", best_kernels().name);
  std::vector<std::shared_ptr<const Expression>> expressions;
  std::vector<Contender> contenders;
  for (const char* text :
       {"u + scale", "sin(u)", "exp(u)", "pow(abs(u), scale)", "snoise(6*P)", "vnoise(6*P)", "fbm(6*P)",
        "snoise4(6*P, u)", "fbm4(6*P, u)", "pnoise(6*P, [7, 7, 7])", "voronoi(6*P)", "rand()", "norm(P)"}) {
    const auto e = Expression::compile(text, symbols, ValueType::Vector);
    contenders.push_back(
        {text,
         [&v, &inputs, e] {
           e->evaluate({int(v.columns[0].size()), inputs}, v.out[0].data(), v.out[1].data(), v.out[2].data());
         },
         {}});
  }
  compare(std::move(contenders), c[0].size(), 51);
}

void one_point_and_bounds() {
  const Symbols symbols = bark_symbols();
  const auto e = Expression::compile("0.6*scale*N*(abs(sin(8*PI*u)) + 0.3*fbm(6*P))", symbols, ValueType::Vector);
  const std::vector<Vec3f> values(4, Vec3f(0.3f));
  const std::vector<IntervalValue> box{
      {{0, 1}, {0, 1}, {0, 1}}, IntervalValue::unit_vector(), IntervalValue::scalar(0, 1), IntervalValue::scalar(0, 1)};
  constexpr std::size_t calls = 2000;
  double sum = 0;
  std::printf("the same, one call a point\n");
  compare({{"evaluate_vector",
            [&] {
              for (std::size_t i = 0; i < calls; ++i) sum += double(e->evaluate_vector(values).x);
            },
            {}},
           {"evaluate_bounds",
            [&] {
              for (std::size_t i = 0; i < calls; ++i) sum += double(e->evaluate_bounds(box).max_length);
            },
            {}}},
          calls, 21);
  if (!std::isfinite(sum)) std::printf("not finite\n");
}

}  // namespace

int main() {
  bark();
  single_functions();
  one_point_and_bounds();
}
