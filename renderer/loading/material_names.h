// The members "material" and "materials" of an object: which materials stand in place of those that its model names. So
// one model serves as several, such as a tree in summer and in autumn.
#pragma once

#include "geometry/base/params.h"

#include <compare>
#include <functional>
#include <map>
#include <string>

namespace meristem {

class MaterialNames {
 public:
  // Reads the two members; `check` reports names that are none.
  using Check = std::function<void(const std::string& name, const Location& where)>;
  static MaterialNames read(Params& params, const Check& check);

  bool empty() const { return all_.empty() && by_name_.empty(); }
  // What stands for a material of the model; the empty name is that of faces which name none.
  const std::string& of(const std::string& name) const;
  // First these, then those of an object that this one is part of.
  MaterialNames then(const MaterialNames& outer) const;
  auto operator<=>(const MaterialNames&) const = default;

 private:
  std::string all_;  // for whatever has no name of its own; empty: it stays
  std::map<std::string, std::string> by_name_;
};

}  // namespace meristem
