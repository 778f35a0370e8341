// What the program says: results on standard output, everything else on standard error.
#pragma once

#include "geometry/base/source.h"

#include <string>
#include <vector>

namespace meristem {

// Throws FileError if standard output does not take it (a full disk).
void print_result(const std::string& text);

// One or more lines; a final newline is added if it is missing.
void print_error(const std::string& text);

// Each with its place, line and caret.
void print_diagnostics(const std::vector<Diagnostic>& list);

}  // namespace meristem
