// A displaced terrain for measurements of expansion: a plane of base_side^2 quads, smooth refinements, then three with
// placement (the bark of scenes/branch on a plain).
#pragma once

#include "geometry/accel/world.h"
#include "procedural/subdivision/subdivide_step.h"
#include "tests/support/shapes.h"

#include <memory>
#include <vector>

namespace meristem {

constexpr int placed_levels = 3;

inline Mesh plain(std::uint32_t side) {
  Mesh mesh;
  mesh.origins = {FaceOrigin{}};
  for (std::uint32_t j = 0; j <= side; ++j)
    for (std::uint32_t i = 0; i <= side; ++i)
      mesh.add_vertex({double(i) / side, 0, double(j) / side}, hash_keys(Key(i), Key(j)));
  for (std::uint32_t j = 0; j < side; ++j)
    for (std::uint32_t i = 0; i < side; ++i) {
      const std::uint32_t v = j * (side + 1) + i;
      const std::uint32_t corners[] = {v, v + side + 1, v + side + 2, v + 1};
      mesh.add_face(corners, hash_keys(Key(i), Key(j), 1), 0);
      for (std::uint32_t c : corners)
        mesh.corner_uv.push_back({double(c % (side + 1)) / side, double(c / (side + 1)) / side});
    }
  return mesh;
}

inline std::shared_ptr<const Model> terrain(std::uint32_t base_side, int levels, const CellSettings& settings = {}) {
  const auto place =
      Expression::compile("0.6*scale*N*(abs(sin(8*PI*u)) + 0.3*fbm(6*P))", placement_symbols(), ValueType::Vector);
  std::vector<std::unique_ptr<Step>> steps;
  for (int level = 1; level <= levels; ++level) {
    SubdivideStep::Settings s;
    s.place = level > levels - placed_levels ? place : nullptr;
    s.level = level;
    s.step_key = hash_keys(99, Key(level));
    steps.push_back(std::make_unique<SubdivideStep>(s));
  }
  return std::make_shared<const Model>("terrain", plain(base_side), std::move(steps), settings);
}

inline std::unique_ptr<Intersector> terrain_world(std::shared_ptr<const Model> model, const WorldOptions& options) {
  Placement object;
  object.part = std::make_shared<const Part>(std::move(model));
  return make_world({object}, options);
}

}  // namespace meristem
