// What it takes to generate whole trees: every stem and leaf as a mesh, on one thread, without subdivision; medians
// over several individuals of wall and processor time. An argument names one species.
#include "geometry/base/huge_pages.h"
#include "geometry/base/params.h"
#include "procedural/components.h"
#include "procedural/plants/weber_penn_step.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <vector>

using namespace meristem;

namespace {

struct Tree {
  double time_s = 0, processor_s = 0;
  std::size_t leaves = 0, faces = 0;
};

Value species_value(const char* species) {
  Value type, name, tree;
  type.kind = name.kind = Value::Kind::Text;
  type.text = "weber_penn";
  name.text = species;
  tree.kind = Value::Kind::Object;
  tree.members = {{"type", {}, type}, {"species", {}, name}};
  return tree;
}

Tree generate(const char* species, Key seed) {
  BaseRegistry bases("base");
  register_plants(bases);
  Diagnostics diagnostics;
  GrowthSymbols symbols;
  const Value value = species_value(species);
  const auto shape = bases.create(value, "", diagnostics);
  BaseContext context{symbols, diagnostics, seed};
  CellMesh cell;
  cell.mesh = shape->build(context);
  const auto steps = shape->growth(context, false);
  cell.owned_faces = cell.mesh.face_count();
  cell.rings.assign(cell.owned_faces, 0);

  Tree tree;
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t processor_start = std::clock();
  for (const auto& step : steps) {
    CellMesh next;
    step->apply(cell, 0, next);
    cell = std::move(next);
  }
  tree.time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  tree.processor_s = double(std::clock() - processor_start) / CLOCKS_PER_SEC;
  tree.faces = cell.mesh.face_count();
  const int leaf = symbols.find("leaf");
  for (const FaceOrigin& o : cell.mesh.origins) tree.leaves += o.symbol == leaf;
  return tree;
}

}  // namespace

int main(int argc, char** argv) {
  restart_with_huge_pages(argv);
  for (const PlantSpecies& species : plant_species()) {
    if (argc > 1 && std::string(argv[1]) != species.name) continue;
    std::vector<Tree> trees;
    for (Key seed = 1; seed <= 9; ++seed) trees.push_back(generate(species.name, seed));
    std::sort(trees.begin(), trees.end(), [](const Tree& a, const Tree& b) { return a.processor_s < b.processor_s; });
    const Tree& t = trees[trees.size() / 2];
    std::printf("%-22s %8.4f s (processor %.4f s)  %9zu faces  %8zu leaves  %5.0f ns a face\n", species.name, t.time_s,
                t.processor_s, t.faces, t.leaves, 1e9 * t.processor_s / double(t.faces));
  }
}
