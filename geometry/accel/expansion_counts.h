// ExpansionCounts: what expansion did, by model and step; and the way to the recorder, if there is one. Touched by
// expansions only. Any thread.
#pragma once

#include "geometry/base/statistics.h"
#include "geometry/cache/expansion_recorder.h"
#include "geometry/cells/expansion.h"

#include <mutex>
#include <set>

namespace meristem {

// An expansion and what it left behind.
struct MadeCell {
  const Model& model;
  int level;            // steps done before
  Key key;              // of the cell, among those of its model and level
  std::int32_t symbol;  // of its first face
  const Expansion& expansion;
  double start_s, built_from_s;  // by ExpansionCounts::now_s(); from built_from_s until now trees were built
  Bounds3f bounds;               // before,
  Bounds3f real_bounds = {};     // and after
};

class ExpansionCounts {
 public:
  // A recorder outlives the counts.
  explicit ExpansionCounts(ExpansionRecorder* recorder = nullptr) : recorder_(recorder) {}

  double now_s() const;
  void add(const Model& model, const Expansion& expansion, double seconds);
  // The same for a cell that becomes an entry of the cache, which is labelled and recorded if there is a recorder.
  void add(const MadeCell& cell, CacheEntry& entry);
  void add_defect(std::string message);  // a cell that left its bounds or could not be expanded: each text kept once
  void write(ExpansionStatistics& statistics) const;

 private:
  void record(const MadeCell& cell, CacheEntry& entry) const;

  ExpansionRecorder* const recorder_;
  mutable std::mutex mutex_;
  std::uint64_t faces_ = 0;
  double time_s_ = 0;
  std::vector<StepStatistics> by_step_;  // by model (all its individuals) and name, in order of appearance
  std::uint64_t failed_ = 0;
  std::set<std::string> defects_;
};

}  // namespace meristem
