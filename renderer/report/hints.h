// Hints: what the figures of a render mean, in words, with what would help. Computed from recorded figures alone.
#pragma once

#include "renderer/report/statistics.h"

#include <string>
#include <vector>

namespace meristem {

struct Hint {
  std::string about;       // "budget", "bounds", "waiting", "time", "latency", "memory"
  std::string text;        // sentences
  bool is_advice = false;  // something may be gained; else it only says how it is
};

// Advice first, each kind in the order of its weight. Nothing if the render recorded nothing.
std::vector<Hint> hints_of(const RenderStatistics& s);

}  // namespace meristem
