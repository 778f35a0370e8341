// What a hit costs besides tracing: choosing one of many lights, and scattering at a surface.
#include "geometry/base/key.h"
#include "renderer/integrators/light_tree.h"
#include "renderer/materials/bsdf.h"

#include <benchmark/benchmark.h>

namespace meristem {
namespace {

float random_number(Key i, Key what) { return uniform_float(hash_keys(i, what)); }
Vec3f random_vector(Key i, Key what) {
  return Vec3f{random_number(i, what), random_number(i, what + 1), random_number(i, what + 2)} * 2 - Vec3f(1);
}

// Small lamps, spread over a square of 40 m.
LightTree lamps(std::int64_t count) {
  std::vector<LightBounds> lights;
  for (Key i = 0; i < Key(count); ++i) {
    LightBounds b;
    const Vec3f place = random_vector(i, 0) * Vec3f{20, 1, 20};
    b.box = {place - Vec3f(0.03f), place + Vec3f(0.03f)};
    b.power = 1 + random_number(i, 3);
    lights.push_back(b);
  }
  return LightTree(lights);
}

void pick_light(benchmark::State& state) {
  const LightTree tree = lamps(state.range(0));
  Key i = 0;
  for (auto _ : state) {
    const Receiver receiver{random_vector(i % 1024, 10) * Vec3f{20, 0, 20}, {0, 1, 0}};
    benchmark::DoNotOptimize(tree.pick(receiver, random_number(i % 1024, 13)));
    ++i;
  }
}
BENCHMARK(pick_light)->Arg(1)->Arg(30)->Arg(1000)->Arg(30000);

void build_tree(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(lamps(state.range(0)));
}
BENCHMARK(build_tree)->Arg(1000)->Arg(30000)->Unit(benchmark::kMillisecond);

BsdfParameters plastic() { return {}; }
BsdfParameters glass() {
  BsdfParameters b;
  b.glass = 1;
  return b;
}
BsdfParameters rough_plastic() {
  BsdfParameters b;
  b.diffuse_roughness = 0.5f;
  return b;
}
BsdfParameters rough_and_coated() {
  BsdfParameters b = rough_plastic();
  b.coat = 1;
  return b;
}
BsdfParameters coated_and_dusty() {
  BsdfParameters b;
  b.coat = 1;
  b.fuzz = 0.5f;
  return b;
}

// Of one hit: the frame, one direction asked for (as for a light), one sampled.
void scatter(benchmark::State& state, BsdfParameters (*make)()) {
  const BsdfParameters parameters = make();
  ShadingPoint point;
  point.hit.geometric_normal = point.hit.shading_normal = {0, 1, 0};
  Key i = 0;
  for (auto _ : state) {
    point.wo = normalize(random_vector(i % 1024, 0) + Vec3f{0, 1.1f, 0});
    const Bsdf bsdf(parameters, point);
    const Vec3f wi = normalize(random_vector(i % 1024, 3) + Vec3f{0, 1.1f, 0});
    benchmark::DoNotOptimize(bsdf.evaluate(point.wo, wi));
    benchmark::DoNotOptimize(bsdf.pdf(point.wo, wi));
    const Vec2f random{random_number(i % 1024, 6), random_number(i % 1024, 7)};
    benchmark::DoNotOptimize(bsdf.sample(point.wo, random, random_number(i % 1024, 8)));
    ++i;
  }
}
BENCHMARK_CAPTURE(scatter, plastic, plastic);
BENCHMARK_CAPTURE(scatter, glass, glass);
BENCHMARK_CAPTURE(scatter, rough_plastic, rough_plastic);
BENCHMARK_CAPTURE(scatter, rough_and_coated, rough_and_coated);
BENCHMARK_CAPTURE(scatter, coated_and_dusty, coated_and_dusty);

}  // namespace
}  // namespace meristem
