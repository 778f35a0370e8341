// What it takes to generate whole trees: every stem and leaf as a mesh, on one thread, without subdivision; medians of
// single runs over several individuals.
#include "geometry/base/params.h"
#include "procedural/components.h"
#include "procedural/plants/weber_penn_step.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

using namespace meristem;

namespace {

struct Tree {
  double time_s = 0;
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
  for (const auto& step : steps) {
    CellMesh next;
    step->apply(cell, 0, next);
    cell = std::move(next);
  }
  tree.time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  tree.faces = cell.mesh.face_count();
  const int leaf = symbols.find("leaf");
  for (const FaceOrigin& o : cell.mesh.origins) tree.leaves += o.symbol == leaf;
  return tree;
}

}  // namespace

int main() {
  for (const PlantSpecies& species : plant_species()) {
    std::vector<Tree> trees;
    for (Key seed = 1; seed <= 5; ++seed) trees.push_back(generate(species.name, seed));
    std::sort(trees.begin(), trees.end(), [](const Tree& a, const Tree& b) { return a.time_s < b.time_s; });
    const Tree& t = trees[trees.size() / 2];
    std::printf("%-22s %8.4f s  %9zu faces  %8zu leaves  %5.0f ns a face\n", species.name, t.time_s, t.faces, t.leaves,
                1e9 * t.time_s / double(t.faces));
  }
}
