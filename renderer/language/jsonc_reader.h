// Reads scene text: JSON (RFC 8259) with // and /* */ comments and trailing commas, into a Value that knows where each
// key and value stands.
//
// Safe to call on text from strangers: the limits below bound memory, stack and time (linear in the text but for the
// sorting of keys). Mistakes that leave the structure clear (a missing comma, a bare word, a repeated key, a bad
// escape, a number that is none) are reported and reading goes on; at the first that does not, it stops. After an error
// the result holds what was understood, for nothing but finding further errors.
#pragma once

#include "geometry/base/value.h"

#include <cstddef>
#include <memory>

namespace meristem {

struct JsoncLimits {
  static constexpr std::size_t file_bytes = std::size_t(64) << 20;
  static constexpr std::size_t text_bytes = std::size_t(64) << 10;  // of one string, decoded
  static constexpr std::size_t key_bytes = 1024;
  static constexpr std::size_t values = 2'000'000;  // some 250 MB of Value
  static constexpr int depth = 64;                  // of arrays and objects in each other
};

Value read_jsonc(std::shared_ptr<const SourceText> source, Diagnostics& diagnostics);

}  // namespace meristem
