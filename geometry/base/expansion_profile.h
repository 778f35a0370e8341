// ExpansionProfile: what lazy expansion did over time and to which cells. Plain figures that the geometry records when
// it is asked to, and the reports print. Times are seconds since recording began, bytes are those the cache counts.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace meristem {

// Where the bytes of expanded geometry are.
struct GeometryMemory {
  std::uint64_t surfaces = 0;       // vertices, normals, texture coordinates of final cells
  std::uint64_t surface_trees = 0;  // hierarchies over them
  std::uint64_t meshes = 0;         // meshes of split cells, from which children are cut
  std::uint64_t box_trees = 0;      // bounds of children, and hierarchies over them
  std::uint64_t limbo = 0;          // evicted, possibly still in use by a ray in flight
  std::uint64_t plans = 0;          // refinement plans shared by cells of one shape

  std::uint64_t resident() const { return surfaces + surface_trees + meshes + box_trees; }
  // What the budget limits.
  std::uint64_t total() const { return resident() + limbo + plans; }
};

// A stretch of time.
struct TimelineBin {
  GeometryMemory memory;  // at the moment in the stretch when their total was largest
  std::uint64_t expanded = 0, reexpanded = 0, evicted = 0, waits = 0, faces = 0;
  double expand_s = 0, build_s = 0, wait_s = 0;  // summed over threads
};

// Cells of one kind: what they are cut from and what becomes of them.
struct CellClass {
  std::string model;
  int level = 0;      // steps done before they are expanded
  std::string rule;   // symbol of their first face, if a rule waits for it; else empty
  bool final = true;  // they become surfaces; else they are split

  bool operator==(const CellClass&) const = default;
};

struct CellClassFigures {
  CellClass cells;
  std::uint64_t expanded = 0, reexpanded = 0, evicted = 0;
  std::uint64_t faces = 0, bytes = 0;  // made, over all expansions
  double expand_s = 0, build_s = 0;
  std::uint64_t visits = 0;  // by rays; an estimate from a sample of them
  // How much larger the box before expansion is than the real one, by surface area: a ray meets a box with a
  // probability proportional to it. Of final cells.
  std::uint64_t boxes = 0;
  double box_ratio_sum = 0, box_ratio_max = 0;

  double mean_box_ratio() const { return boxes ? box_ratio_sum / double(boxes) : 0; }
};

// One activity of one thread.
struct ActivitySpan {
  enum class Kind : std::uint8_t { Expand, Wait };
  double start_s = 0;
  float duration_s = 0;
  float build_s = 0;  // of it, at the end: trees
  Kind kind = Kind::Expand;
  bool is_reexpansion = false;
  std::uint32_t cell_class = 0;  // index into ExpansionProfile::classes
  std::uint32_t faces = 0, bytes = 0;
};

struct ThreadProfile {
  double expand_s = 0, build_s = 0, wait_s = 0;  // expand_s without build_s
  double trace_s = 0;  // in trees, without the three above; an estimate from a sample of rays, which go alone
  std::uint64_t expansions = 0, waits = 0, rays = 0;
  std::vector<ActivitySpan> spans;  // in order
  std::uint32_t span_stride = 1;    // every so many-th is kept
};

// Counts of durations: bin i holds those from lower_bound(i) up to lower_bound(i + 1).
struct LatencyHistogram {
  static constexpr int bins_per_octave = 2;
  static constexpr int bin_count = 54;  // 1 us to 134 s
  static double lower_bound_s(int bin);
  void add(double seconds);
  LatencyHistogram& operator+=(const LatencyHistogram& o);
  // The duration that a share of all stays below, to the width of a bin; 0 if there are none.
  double quantile_s(double share) const;
  std::uint64_t total() const;

  std::array<std::uint64_t, bin_count> counts{};
  double max_s = 0;
};

// How many of the repeated expansions a larger budget would have saved. Estimated from distances of reuse: see
// geometry/cache/reuse_distance.h.
struct ReuseFigures {
  struct Step {
    std::uint64_t budget_bytes = 0;
    double reexpanded = 0;  // that would be left with this budget
  };
  double sampled_share = 1;  // of the cells
  double distinct_cells = 0;
  double distinct_bytes = 0;  // of all of them together
  double reexpanded = 0;
  std::vector<Step> by_budget;  // ascending budgets, descending counts; the last is 0
};

struct ExpansionProfile {
  double duration_s = 0;
  std::uint64_t budget_bytes = 0;  // 0: none
  double bin_s = 0;                // width of the bins
  std::vector<TimelineBin> timeline;
  std::vector<CellClassFigures> classes;
  std::vector<ThreadProfile> threads;
  LatencyHistogram latency;  // of expansions, building included
  LatencyHistogram waits;
  ReuseFigures reuse;
  std::uint32_t ray_stride = 1;  // every so many-th ray was sampled
};

}  // namespace meristem
