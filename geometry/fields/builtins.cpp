#include "geometry/fields/builtins.h"

#include "geometry/fields/builder.h"

#include <algorithm>

namespace meristem {

namespace {

const std::vector<Builtin>& all_builtins() {
  static const std::vector<Builtin> all = [] {
    std::vector<Builtin> list;
    for (const std::span<const Builtin> group :
         {arithmetic_builtins(), colour_builtins(), noise_builtins(), chance_builtins(), curve_builtins()})
      list.insert(list.end(), group.begin(), group.end());
    return list;
  }();
  return all;
}

}  // namespace

const Builtin* find_builtin(std::string_view name) {
  const auto found = std::ranges::find(all_builtins(), name, [](const Builtin& b) { return b.info.name; });
  return found == all_builtins().end() ? nullptr : &*found;
}

const std::vector<std::string>& builtin_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Builtin& b : all_builtins()) list.emplace_back(b.info.name);
    return list;
  }();
  return names;
}

std::span<const FunctionInfo> expression_functions() {
  static const std::vector<FunctionInfo> infos = [] {
    std::vector<FunctionInfo> list;
    for (const Builtin& b : all_builtins()) list.push_back(b.info);
    return list;
  }();
  return infos;
}

}  // namespace meristem
