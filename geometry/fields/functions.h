// The list of all functions of the expression language: for manual pages, completion and error messages.
// Constant data; any thread.
#pragma once

#include <span>
#include <string_view>

namespace meristem {

struct FunctionInfo {
  std::string_view name;
  std::string_view group;      // "curves", "noise", ...
  std::string_view signature;  // "clamp(x, lo, hi)"; parameters with = may be left out, ... may be repeated
  std::string_view doc;        // one line
};

// Grouped, in the order of docs/expressions.md.
std::span<const FunctionInfo> expression_functions();

}  // namespace meristem
