// Values made in code, to be written by to_json().
#pragma once

#include "geometry/base/value.h"

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace meristem::json {

inline Value number(double x) {
  Value v;
  v.kind = Value::Kind::Number;
  v.number = x;
  return v;
}

// Counts are exact up to 2^53.
inline Value count(std::uint64_t n) { return number(double(n)); }

inline Value text(std::string s) {
  Value v;
  v.kind = Value::Kind::Text;
  v.text = std::move(s);
  return v;
}

inline Value boolean(bool b) {
  Value v;
  v.kind = Value::Kind::Bool;
  v.boolean = b;
  return v;
}

inline Value array(std::vector<Value> items) {
  Value v;
  v.kind = Value::Kind::Array;
  v.items = std::move(items);
  return v;
}

inline Value object(std::initializer_list<std::pair<const char*, Value>> members) {
  Value v;
  v.kind = Value::Kind::Object;
  for (const auto& [key, value] : members) v.members.push_back({key, {}, value});
  return v;
}

}  // namespace meristem::json
