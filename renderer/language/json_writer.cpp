#include "renderer/language/json_writer.h"

#include <fmt/format.h>

#include <cmath>

namespace meristem {

namespace {

constexpr std::size_t line_width = 100;

std::string scalar(const Value& v) {
  switch (v.kind) {
    case Value::Kind::Bool: return v.boolean ? "true" : "false";
    case Value::Kind::Number: return std::isfinite(v.number) ? fmt::format("{}", v.number) : "null";
    case Value::Kind::Text: return json_quoted(v.text);
    default: return "null";
  }
}

// What stands between the brackets: each item, or each key and value, written by `write`.
template <class Write>
std::vector<std::string> parts_of(const Value& v, const Write& write) {
  std::vector<std::string> parts;
  for (const Value& item : v.items) parts.push_back(write(item));
  for (const Member& member : v.members) parts.push_back(json_quoted(member.key) + ": " + write(member.value));
  return parts;
}

std::string on_lines(const Value& v, std::size_t indent) {
  if (v.kind != Value::Kind::Array && v.kind != Value::Kind::Object) return scalar(v);
  const bool array = v.kind == Value::Kind::Array;
  const auto parts = parts_of(v, [&](const Value& item) { return on_lines(item, indent + 2); });
  if (parts.empty()) return array ? "[]" : "{}";
  const std::string inside = fmt::format("{}", fmt::join(parts, ", "));
  const std::string line = array ? "[" + inside + "]" : "{ " + inside + " }";
  if (line.find('\n') == std::string::npos && indent + line.size() <= line_width) return line;
  const std::string margin(indent, ' ');
  const std::string between = ",\n" + margin + "  ";
  return fmt::format("{}\n{}  {}\n{}{}", array ? '[' : '{', margin, fmt::join(parts, between), margin,
                     array ? ']' : '}');
}

}  // namespace

std::string json_quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      result += '\\', result += c;
    else if (std::uint8_t(c) < 0x20)
      result += fmt::format("\\u{:04x}", std::uint8_t(c));
    else
      result += c;
  }
  return result + '"';
}

std::string to_json(const Value& value) { return on_lines(value, 0); }

}  // namespace meristem
