// Writes a Value as JSON: indented by two spaces, short arrays and objects on one line, numbers so that they read back
// the same. Numbers that are not finite become null. No final newline.
#pragma once

#include "geometry/base/value.h"

#include <string>

namespace meristem {

std::string to_json(const Value& value);
// A text in quotes.
std::string json_quoted(const std::string& text);

}  // namespace meristem
