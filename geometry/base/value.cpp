#include "geometry/base/value.h"

#include <algorithm>

namespace meristem {

namespace {

// How many bytes of UTF-8 the escape \uXXXX at `at` stands for: 1 to 3; half of the 4 for each half of a surrogate
// pair.
std::size_t bytes_of_unicode_escape(std::string_view raw, std::size_t at) {
  unsigned code = 0;
  for (const char c : raw.substr(std::min(at + 2, raw.size()), 4))
    code = code * 16 + unsigned(c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10);
  if (code >= 0xd800 && code <= 0xdfff) return 2;
  return code < 0x80 ? 1 : code < 0x800 ? 2 : 3;
}

}  // namespace

const Value* Value::find(std::string_view key) const {
  for (const Member& member : members)
    if (member.key == key) return &member.value;
  return nullptr;
}

const char* Value::kind_name() const {
  switch (kind) {
    case Kind::Null: return "null";
    case Kind::Bool: return boolean ? "true" : "false";
    case Kind::Number: return "a number";
    case Kind::Text: return "text";
    case Kind::Array: return "an array";
    case Kind::Object: return "an object";
  }
  return "nothing";
}

Location text_location(const Value& text, std::size_t offset) {
  if (!text.location.source) return text.location;
  const std::string_view raw = text.location.source->text;
  std::size_t at = text.location.offset + 1;  // after the opening quote
  for (std::size_t decoded = 0; decoded < offset && at < raw.size();) {
    const bool escape = raw[at] == '\\' && at + 1 < raw.size();
    const bool unicode = escape && raw[at + 1] == 'u';
    decoded += unicode ? bytes_of_unicode_escape(raw, at) : 1;
    at += unicode ? 6 : escape ? 2 : 1;
  }
  return {text.location.source, std::min(at, raw.size())};
}

}  // namespace meristem
