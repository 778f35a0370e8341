// What it costs rays that geometry is made of cells: incoherent rays over a displaced terrain of 1,048,576 quads, all
// resident, against the same faces in one tree of ours (--expand flat) and in one Embree scene of grids; and cells
// with 64 rays at once. The four in turns, on one thread, by processor time.
//
//   bench_rays [ROUNDS] [FACES OF A LEAF]
#include "geometry/base/huge_pages.h"
#include "geometry/base/parallel.h"
#include "tests/bench/embree_grids.h"
#include "tests/bench/terrain.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>

using namespace meristem;

namespace {

constexpr int rays = 64 * 3000;

// From just above the terrain to somewhere on it.
Ray random_ray(Key key) {
  const auto r = [&](Key i) { return uniform_float(hash_keys(key, i)); };
  const Vec3f from{r(1), 0.01f + 0.04f * r(5), r(2)}, to{r(3), 0, r(4)};
  return {from, normalize(to - from)};
}

// Rays a second.
template <class World>
double speed(const World& world, Key round, int& hits) {
  const std::clock_t start = std::clock();
  for (int i = 0; i < rays; ++i) {
    SurfaceHit hit;
    hits += world.intersect(random_ray(hash_keys(round, Key(i))), hit);
  }
  return rays * double(CLOCKS_PER_SEC) / double(std::clock() - start);
}

// The same of rays that are traced together.
double speed_together(const Intersector& world, Key round, int& hits) {
  constexpr int batch = 64;
  std::vector<Ray> some(batch);
  std::vector<SurfaceHit> met(batch);
  std::vector<RayQuery> queries(batch);
  const std::clock_t start = std::clock();
  for (int i = 0; i < rays; i += batch) {
    for (int k = 0; k < batch; ++k) {
      some[std::size_t(k)] = random_ray(hash_keys(round, Key(i + k)));
      queries[std::size_t(k)] = {&some[std::size_t(k)], &met[std::size_t(k)]};
    }
    world.trace(queries);
    for (const RayQuery& q : queries) hits += q.met;
  }
  return rays * double(CLOCKS_PER_SEC) / double(std::clock() - start);
}

}  // namespace

int main(int argc, char** argv) {
  restart_with_huge_pages(argv);
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 7;
  flush_denormals();
  CellSettings settings;
  if (argc > 2) settings = {std::uint32_t(std::atoi(argv[2])), 8 * std::uint32_t(std::atoi(argv[2]))};
  const auto model = terrain(32, 5, settings);
  const auto cells = terrain_world(model, {.mode = ExpandMode::Eager}),
             flat = terrain_world(model, {.mode = ExpandMode::Flat});
  const EmbreeGrids embree(model);
  std::vector<double> of_cells, together, of_flat, of_embree, to_flat, to_embree, to_alone;
  int hits = 0;
  for (int round = 0; round < rounds; ++round) {
    of_cells.push_back(speed(*cells, Key(round), hits));
    together.push_back(speed_together(*cells, Key(round), hits));
    of_flat.push_back(speed(*flat, Key(round), hits));
    of_embree.push_back(speed(embree, Key(round), hits));
    to_flat.push_back(of_cells.back() / of_flat.back());
    to_embree.push_back(of_cells.back() / of_embree.back());
    to_alone.push_back(together.back() / of_cells.back());
  }
  std::ranges::sort(to_flat);
  std::ranges::sort(to_embree);
  std::ranges::sort(to_alone);
  std::printf(
      "incoherent rays: cells %.3f, flat %.3f, Embree %.3f million rays/s at best; cells %.3f of flat, %.3f of "
      "Embree, medians of %d (%d hits); cells together %.3f, %.3f of those one by one\n",
      1e-6 * std::ranges::max(of_cells), 1e-6 * std::ranges::max(of_flat), 1e-6 * std::ranges::max(of_embree),
      to_flat[to_flat.size() / 2], to_embree[to_embree.size() / 2], rounds, hits, 1e-6 * std::ranges::max(together),
      to_alone[to_alone.size() / 2]);
}
