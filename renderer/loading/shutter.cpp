#include "renderer/loading/shutter.h"

#include <fmt/format.h>

namespace meristem {

bool report_errors_at(double time, const Diagnostics& found, Diagnostics& diagnostics) {
  for (const Diagnostic& d : found.list())
    if (d.severity == Diagnostic::Severity::Error)
      diagnostics.error(d.location, fmt::format("at time {:g}: {}", time, d.message));
  return found.has_errors();
}

}  // namespace meristem
