// Timeline: figures over time in a bounded number of bins of equal width. When time runs past the last bin, neighbours
// are merged and the width doubles. One thread at a time.
#pragma once

#include "geometry/base/expansion_profile.h"

#include <vector>

namespace meristem {

class Timeline {
 public:
  static constexpr std::size_t max_bins = 1024;

  explicit Timeline(double first_bin_s = 0.002) : bin_s_(first_bin_s) {}

  // The bin of a moment, which is not before the last one asked for with `memory`; new bins hold what was resident
  // last.
  TimelineBin& at(double time_s);
  void set_memory(double time_s, const GeometryMemory& memory);
  // Adds a stretch of work to the bins it lies in.
  void add_work(double start_s, double end_s, double TimelineBin::*kind);

  double bin_s() const { return bin_s_; }
  std::size_t size() const { return bins_.size(); }
  const std::vector<TimelineBin>& bins() const { return bins_; }

 private:
  void halve();

  double bin_s_;
  GeometryMemory memory_;  // now
  std::vector<TimelineBin> bins_;
};

}  // namespace meristem
