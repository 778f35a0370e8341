// World: objects (parts placed by transforms) behind one Intersector, expanded lazily, eagerly or flat.
//
//   Lazy   a cell expands when a ray enters its bounds; the geometry cache forgets what is no longer used
//   Eager  the same cells and the same code, all expanded before the first ray; nothing is forgotten
//   Flat   each model's whole final mesh under one tree, as the paper's renderer did
//
// Lazy and eager give the same hits bit for bit, for any budget, number of threads and order of rays: what a cell
// expands to is a pure function of the model, cells are traced through the same hierarchy whether resident or not, and
// of two hits at the same distance the one with the smaller cell key wins. Flat differs at most in such ties.
#pragma once

#include "geometry/accel/intersector.h"
#include "geometry/cells/part.h"
#include "geometry/cells/uv_readers.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace meristem {

enum class ExpandMode : std::uint8_t { Lazy, Eager, Flat };

struct WorldOptions {
  ExpandMode mode = ExpandMode::Lazy;
  std::size_t budget_bytes = std::size_t(2) << 30;       // of the geometry cache (Lazy)
  int threads = 1;                                       // for expanding everything (Eager, Flat)
  std::shared_ptr<const Footprint> footprint = nullptr;  // in world space; null: everything in full
  bool record = false;                                   // Intersector::profile() then has figures (Lazy, Eager)
  // What rays of other classes than the camera's want to see; null: the same. Rays of classes with one footprint object
  // see one world.
  std::shared_ptr<const Footprint> diffuse_footprint = nullptr, shadow_footprint = nullptr;
  // Of surfaces of other materials hits have neither u, v nor tangents.
  UvReaders uv_readers = {};
  // Where a file may keep surfaces that the budget has no room for (Lazy); empty: nowhere, they are expanded again.
  std::string scratch_directory = {};
};

// The least budget that can hold what one ray of each thread needs at once: a chain of cells from the root to a
// surface, and their refinement plans. Expands such a chain for each part of the scene, so some milliseconds a part; 0
// without looking if the budget is ample (64 MiB a thread). With less a render would expand the same cells again at
// every step of every ray.
std::size_t least_budget(const std::vector<Placement>& objects, const WorldOptions& options);

// Makes the world; Eager and Flat expand here. Throws std::runtime_error if Embree fails or no scratch file can be
// made.
std::unique_ptr<Intersector> make_world(std::vector<Placement> objects, const WorldOptions& options);

}  // namespace meristem
