// How closed a closed model is: a grown branch with two displaced levels, in cells of 64 faces, in full and where
// levels of detail meet. Random rays from inside and rays aimed at edges and vertices along which cells meet, lazily
// and through braided cells, and those that escape once more against the same faces in one scene.
//
//   bench_closed [RAYS OF EACH KIND]
#include "tests/renderer/loading/branch_scene.h"
#include "tests/support/inside_walk.h"
#include "tests/support/point_footprint.h"

#include <cstdio>
#include <cstdlib>

using namespace meristem;

namespace {

void measure(const char* name, ExpandMode mode, const std::shared_ptr<const Footprint>& footprint, int rays) {
  constexpr int rays_per_walk = 5000;
  const auto model = model_of(branch_text(), 0, {64, 256});
  const Borders borders(*model, footprint.get());
  const Placement object{std::make_shared<const Part>(model), {}, 0, true};
  const auto world = make_world({object}, {.mode = mode, .footprint = footprint}),
             flat = make_world({object}, {.mode = ExpandMode::Flat, .footprint = footprint});
  EscapeCounts counts;
  const int walks = std::max(1, rays / rays_per_walk);
  walk_inside(*world, *flat, borders, {0, 0.25f, 0}, walks, rays_per_walk, counts);
  std::printf("%s, %zu edges between cells\n", name, borders.count());
  std::printf("  random: %d of %d escape\n", counts.random_escapes.load(), walks * rays_per_walk);
  std::printf("  aimed at an edge: %d of %d escape\n", counts.edge_escapes.load(), counts.at_edges.load());
  std::printf("  aimed at a vertex: %d of %d escape\n", counts.vertex_escapes.load(), counts.at_vertices.load());
  std::printf("  of these, hit the same faces in one scene: %d\n", counts.between_cells.load());
}

}  // namespace

int main(int argc, char** argv) {
  const int rays = argc > 1 ? std::atoi(argv[1]) : 1000000;
  flush_denormals();
  const auto levels = std::make_shared<PointFootprint>(Vec3d{1, 0.5, 0.5}, 0.02);
  for (const auto& [cells, mode] : {std::pair{"cells", ExpandMode::Lazy}, {"braided cells", ExpandMode::Eager}}) {
    std::printf("%s:\n", cells);
    measure("in full", mode, nullptr, rays);
    measure("levels of detail from 1 m away", mode, levels, rays);
  }
}
