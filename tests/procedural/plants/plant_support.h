// What the tests of plants share: trees from scene text.
#pragma once

#include "geometry/cells/expansion.h"
#include "procedural/growth/base_shape.h"
#include "procedural/plants/weber_penn_step.h"
#include "procedural/subdivision/subdivide_step.h"
#include "tests/procedural/growth/derivation.h"

#include <gtest/gtest.h>

namespace meristem::test {

// `members`: what stands in { "type": "weber_penn", ... }.
inline WeberPennParameters parameters_of(const std::string& members) {
  const Value value = JsonText("{" + members + "}").read();
  Diagnostics diagnostics;
  Params params(value, "weber_penn", diagnostics);
  WeberPennParameters p = read_weber_penn(params);
  EXPECT_TRUE(diagnostics.list().empty()) << members;
  return p;
}

inline std::unique_ptr<BaseShape> tree_base(const Value& value, Diagnostics& diagnostics) {
  BaseRegistry bases("base");
  register_plants(bases);
  return bases.create(value, "", diagnostics);
}

// A model of one tree; so many subdivisions follow, with a placement or smooth.
inline std::shared_ptr<const Model> tree_model(const std::string& members, Key seed = 0, int subdivisions = 0,
                                               CellSettings cells = {}, const char* place = nullptr) {
  const Value value = JsonText("{ \"type\": \"weber_penn\", " + members + "}").read();
  Diagnostics diagnostics;
  GrowthSymbols symbols;
  const auto shape = tree_base(value, diagnostics);
  EXPECT_TRUE(shape && diagnostics.list().empty()) << members;
  BaseContext context{symbols, diagnostics, seed};
  Mesh mesh = shape->build(context);
  auto steps = shape->growth(context, subdivisions > 0);
  const auto placement = place ? Expression::compile(place, placement_symbols(), ValueType::Vector) : nullptr;
  for (int i = 0; i < subdivisions; ++i)
    steps.push_back(std::make_unique<SubdivideStep>(SubdivideStep::Settings{{}, placement, i + 1, Key(i), Quantum()}));
  return std::make_shared<const Model>("tree", std::move(mesh), std::move(steps), cells);
}

// The mesh before step `level`, grown whole.
inline Mesh grown(const Model& model, int level) {
  CellMesh cell = model.base();
  for (int i = 0; i < level; ++i) {
    CellMesh next;
    model.step(i).apply(cell, 0, next);
    cell = std::move(next);
  }
  return cell.mesh;
}

inline StemBud trunk_of(const WeberPennParameters& p, Key key) {
  return trunk_bud(p, {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {0, 0, 0}}, key);
}

// Calls visit(stem) for a stem and all that grow on it.
template <class Visit>
void for_each_stem(const WeberPennParameters& p, const StemBud& bud, const Visit& visit) {
  const Stem stem(p, bud);
  visit(stem);
  if (stem.bears_leaves()) return;
  std::vector<StemChild> children;
  stem.find_children(children);
  for (const StemChild& c : children) for_each_stem(p, c.bud, visit);
}

}  // namespace meristem::test
