#include "geometry/cache/timeline.h"

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

TimelineBin merged(const TimelineBin& a, const TimelineBin& b) {
  TimelineBin r = a;
  if (b.memory.total() > a.memory.total()) r.memory = b.memory;
  r.expanded += b.expanded;
  r.reexpanded += b.reexpanded;
  r.evicted += b.evicted;
  r.waits += b.waits;
  r.faces += b.faces;
  r.expand_s += b.expand_s;
  r.build_s += b.build_s;
  r.wait_s += b.wait_s;
  return r;
}

}  // namespace

void Timeline::halve() {
  std::vector<TimelineBin> half;
  for (std::size_t i = 0; i < bins_.size(); i += 2)
    half.push_back(i + 1 < bins_.size() ? merged(bins_[i], bins_[i + 1]) : bins_[i]);
  bins_ = std::move(half);
  bin_s_ *= 2;
}

TimelineBin& Timeline::at(double time_s) {
  while (time_s >= bin_s_ * double(max_bins)) halve();
  const std::size_t index = std::size_t(std::max(time_s, 0.0) / bin_s_);
  TimelineBin empty;
  empty.memory = memory_;
  if (index >= bins_.size()) bins_.resize(index + 1, empty);
  return bins_[index];
}

void Timeline::set_memory(double time_s, const GeometryMemory& memory) {
  TimelineBin& bin = at(time_s);
  memory_ = memory;
  if (memory.total() > bin.memory.total()) bin.memory = memory;
}

void Timeline::add_work(double start_s, double end_s, double TimelineBin::*kind) {
  at(end_s);
  for (double from = std::max(start_s, 0.0); from < end_s;) {
    const double to = std::min(end_s, (std::floor(from / bin_s_) + 1) * bin_s_);
    at(from).*kind += to - from;
    if (to <= from) break;
    from = to;
  }
}

}  // namespace meristem
