// Whether the budget is a promise about the process: rays over a terrain far larger than it until so many cells have
// been evicted; prints the most that the resident set exceeded that of the empty scene, against the budget.
//
//   prlimit --as=2147483648 bench_memory [EVICTIONS] [BUDGET_MIB] [THREADS] [LEAF_FACES]
#include "geometry/base/huge_pages.h"
#include "geometry/base/parallel.h"
#include "geometry/base/process_memory.h"
#include "tests/bench/terrain.h"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>

using namespace meristem;

namespace {

constexpr double mebibyte = 1 << 20;
constexpr double allowed_share = 1.1, allowed_mib = 32;

// Down onto the terrain or along it, anywhere.
Ray random_ray(Key key) {
  const auto r = [&](Key i) { return uniform_float(hash_keys(key, i)); };
  const Vec3f from{r(1), 0.05f, r(2)}, to{r(3), 0, r(4)};
  return {from, key % 2 ? Vec3f{0, -1, 0} : normalize(to - from)};
}

double argument(int argc, char** argv, int i, double fallback) { return argc > i ? std::atof(argv[i]) : fallback; }

}  // namespace

int main(int argc, char** argv) {
  restart_with_huge_pages(argv);
  const auto evictions = std::uint64_t(argument(argc, argv, 1, 1e5));
  const double budget_mib = argument(argc, argv, 2, 64);
  const int threads = int(argument(argc, argv, 3, 2));
  const auto leaf_faces = std::uint32_t(argument(argc, argv, 4, 64));
  constexpr int levels = 10;
  const auto model = terrain(8, levels, {leaf_faces, 8 * leaf_faces});

  // Embree's device, threads and the first few cells are there before anything is counted
  const auto warm = terrain_world(terrain(2, placed_levels), {});
  SurfaceHit hit;
  warm->intersect({{0.5f, 1, 0.5f}, {0, -1, 0}}, hit);
  const std::size_t empty = resident_set_bytes();

  const auto world = terrain_world(model, {.budget_bytes = std::size_t(budget_mib * mebibyte)});
  constexpr std::uint64_t rays_a_round = 4096;
  std::size_t peak = 0;
  std::uint64_t rays = 0;
  while (world->statistics().evicted < evictions) {
    std::atomic<std::uint64_t> next{rays};
    rays += rays_a_round;
    run_threads(threads, [&](int thread) {
      for (std::uint64_t i; (i = next.fetch_add(1)) < rays;) {
        SurfaceHit met;
        world->intersect(random_ray(i), met);
        if (thread == 0 && i % 16 == 0) peak = std::max(peak, resident_set_bytes());
      }
    });
  }
  const ExpansionStatistics s = world->statistics();
  const double used = double(peak - std::min(peak, empty)) / mebibyte;
  const double allowed = allowed_share * budget_mib + allowed_mib;
  std::printf(
      "%llu evictions, %llu rays, %d threads: budget %.0f MiB, counted at most %.1f MiB (resident %.1f, limbo %.1f, "
      "plans %.1f), resident set %.1f MiB above that of an empty scene, allowed %.1f\n",
      (unsigned long long)s.evicted, (unsigned long long)rays, threads, budget_mib,
      double(s.total_bytes_peak) / mebibyte, double(s.resident_bytes_peak) / mebibyte,
      double(s.limbo_bytes_peak) / mebibyte, double(s.plan_bytes) / mebibyte, used, allowed);
  return used <= allowed ? 0 : 1;
}
