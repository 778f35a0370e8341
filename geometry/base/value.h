// Value: a tree of data with positions, as read from a scene file (renderer/language reads it from JSON) or made in
// code. Immutable after reading; objects keep the order of their members.
#pragma once

#include "geometry/base/source.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace meristem {

struct Member;

struct Value {
  enum class Kind : std::uint8_t { Null, Bool, Number, Text, Array, Object };

  Kind kind = Kind::Null;
  bool boolean = false;
  double number = 0;
  std::string text;
  std::vector<Value> items;     // of an Array
  std::vector<Member> members;  // of an Object, in the order written; keys are unique
  Location location;            // of its first byte (for Text: of the opening quote)

  // The member's value, or nullptr. Linear in the number of members.
  const Value* find(std::string_view key) const;
  // "a number", "text", "an array", ... for messages.
  const char* kind_name() const;
};

struct Member {
  std::string key;
  Location key_location;
  Value value;
};

// Where byte `offset` of a Text's content stands in the source, escapes counted: for errors inside a string.
Location text_location(const Value& text, std::size_t offset);

}  // namespace meristem
