// Shutter: the times of one frame at which what changes is read from the scene file.
#pragma once

#include "geometry/base/source.h"

namespace meristem {

struct Shutter {
  double opens = 0;   // in frames
  double length = 0;  // in frames; 0: it opens for a moment only, and nothing changes
  int moments = 1;    // of growth

  bool is_open() const { return length > 0; }

  // Transforms and cameras are read at this many times, and are interpolated between them.
  static constexpr int keys = 17;
  double key_time(int key) const { return opens + length * key / (keys - 1); }
  // Models are built as they are in the middle of each moment.
  double moment_time(int moment) const { return is_open() ? opens + length * (moment + 0.5) / moments : opens; }
};

// Reports the errors that came up when something was read again at another time; warnings have been heard. Whether
// there are any.
bool report_errors_at(double time, const Diagnostics& found, Diagnostics& diagnostics);

}  // namespace meristem
