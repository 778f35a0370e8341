// What expansion did: plain figures that the geometry fills and the reports print. Counts since the scene was built;
// times are wall-clock seconds summed over threads, so they may exceed the time of the render.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace meristem {

struct StepStatistics {
  std::string model;        // its name in the scene; all its individuals together
  std::string step;         // Step::name() and its level: "grow 2", "subdivide 3 (placed)"
  std::uint64_t cells = 0;  // expansions that this step answered, repeated ones among them
  std::uint64_t faces = 0;  // owned faces they made
  double time_s = 0;
};

struct ExpansionStatistics {
  std::uint64_t cells_expanded = 0;  // all expansions, the repeated ones among them
  std::uint64_t reexpanded = 0;      // of these: cells that had been expanded and evicted before
  std::uint64_t read_back = 0;       // of these: surfaces that were read from the scratch file instead
  std::uint64_t evicted = 0;
  std::uint64_t failed = 0;  // of the expansions: cells drawn as their bounds, or that reach beyond them
  std::uint64_t faces = 0;   // owned faces made
  double time_s = 0;
  std::uint64_t waits = 0;         // times a thread slept for a cell that another one expanded
  std::uint64_t invalid_rays = 0;  // not finite or without direction: they hit nothing
  std::uint64_t resident_bytes_peak = 0;
  std::uint64_t limbo_bytes_peak = 0;  // evicted, but possibly still in use by a ray in flight
  std::uint64_t plan_bytes = 0;        // refinement plans shared by cells of one shape, at the end
  std::uint64_t total_bytes_peak = 0;  // of all geometry together: what the budget limits
  std::uint64_t scratch_bytes = 0;     // of the scratch file
  std::vector<std::string> defects;    // each kind once: cells that left their bounds or could not be expanded
  std::vector<StepStatistics> by_step;
};

}  // namespace meristem
