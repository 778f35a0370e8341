// Values made in code, for tests of what reads them.
#pragma once

#include "geometry/base/value.h"

#include <initializer_list>
#include <string>
#include <utility>

namespace meristem::testing {

inline Value number(double x) {
  Value v;
  v.kind = Value::Kind::Number;
  v.number = x;
  return v;
}

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

}  // namespace meristem::testing
