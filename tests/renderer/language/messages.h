// What a reader said, as plain text: shared by the tests of this folder.
#pragma once

#include "renderer/language/jsonc_reader.h"

#include <string>

namespace meristem::testing {

inline std::shared_ptr<const SourceText> source_of(std::string text) {
  return std::make_shared<const SourceText>(SourceText{"scene.jsonc", std::move(text)});
}

// "line:column: message", one a line, in the order in which they were found.
inline std::string messages_of(const Diagnostics& diagnostics) {
  std::string result;
  for (const Diagnostic& d : diagnostics.list())
    result += std::to_string(d.location.line()) + ":" + std::to_string(d.location.column()) + ": " + d.message + "\n";
  return result;
}

}  // namespace meristem::testing
