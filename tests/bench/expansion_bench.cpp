// What expansion takes, from the compact description to what rays can be traced into: a displaced terrain of
// 1,048,576 quads, five levels of which three are placed, split into cells of some 1000 quads, halos and Embree's
// hierarchies included; on one thread, by processor time. And what it leaves behind: bytes a triangle.
//
//   bench_expansion [RUNS] [FACES OF A LEAF] [SIDE OF THE BASE MESH]
#include "geometry/base/huge_pages.h"
#include "geometry/base/parallel.h"
#include "geometry/base/process_memory.h"
#include "tests/bench/terrain.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>

using namespace meristem;

int main(int argc, char** argv) {
  restart_with_huge_pages(argv);
  const int runs = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
  const auto side = std::uint32_t(argc > 3 ? std::atoi(argv[3]) : 32);
  constexpr int levels = 5;
  const double quads = double(side) * side * (1 << 2 * levels);
  CellSettings settings;
  if (argc > 2) settings = {std::uint32_t(std::atoi(argv[2])), 8 * std::uint32_t(std::atoi(argv[2]))};
  flush_denormals();
  std::vector<double> times;
  for (int run = 0; run < runs; ++run) {
    const auto model = terrain(side, levels, settings);
    const std::size_t before = resident_set_bytes();
    const std::clock_t start = std::clock();
    const auto world = terrain_world(model, {.mode = ExpandMode::Eager});
    times.push_back(double(std::clock() - start) / CLOCKS_PER_SEC);
    if (run > 0) continue;
    const ExpansionStatistics s = world->statistics();
    std::printf("%.0f quads in %llu cells: %.1f bytes a triangle counted, %.1f by resident set\n", quads,
                (unsigned long long)s.cells_expanded, double(s.resident_bytes_peak) / (2 * quads),
                double(resident_set_bytes() - before) / (2 * quads));
  }
  std::ranges::sort(times);
  std::printf("a quad: %.0f ns at best, %.0f ns median of %d; %.2f million quads/s and core at best\n",
              1e9 * times[0] / quads, 1e9 * times[times.size() / 2] / quads, runs, 1e-6 * quads / times[0]);
}
