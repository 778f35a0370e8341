// Recording: what a render recorded of itself (`meristem profile`, `render --profile`), as JSON for the reports and as
// a Chrome trace for Perfetto (ui.perfetto.dev), speedscope or chrome://tracing.
#pragma once

#include "geometry/base/expansion_profile.h"
#include "geometry/base/value.h"

#include <string>
#include <vector>

namespace meristem {

// The memory of the process now and then, about 4000 times at most: when there are more, every second one goes.
class MemorySamples {
 public:
  struct Sample {
    double age_s = 0;  // of the process
    std::uint64_t resident_bytes = 0;
  };
  void add(const Sample& sample);
  const std::vector<Sample>& list() const { return list_; }

 private:
  std::vector<Sample> list_;
  std::size_t seen_ = 0, stride_ = 1;
};

struct Recording {
  ExpansionProfile expansion;
  double start_s = 0;  // age of the process when the clock of `expansion` began
  MemorySamples process;
};

// Seconds of threads: summed over those that rendered.
struct PhaseTimes {
  double load = 0;                                    // of one thread, before the first ray
  double expand = 0, build = 0, wait = 0, trace = 0;  // trace is an estimate
  double shade = 0;                                   // the rest of the rendering: materials, lights, camera, film
};
PhaseTimes phase_times(const ExpansionProfile& profile, double load_s, double render_s, int threads,
                       bool expands_while_loading);

// The member "profile" of the statistics; docs/statistics.schema.json says what it holds.
Value recording_value(const Recording& recording, const PhaseTimes& phases);

// In the JSON trace event format (Google, "Trace Event Format"). Times count from the start of the process.
std::string chrome_trace(const Recording& recording, double load_s, double render_s);

}  // namespace meristem
