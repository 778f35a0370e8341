#include "renderer/language/catalogue.h"

#include <algorithm>

namespace meristem {

std::vector<std::string> Catalogue::kinds() const {
  std::vector<std::string> result;
  for (const ComponentInfo& c : components)
    if (std::find(result.begin(), result.end(), c.kind) == result.end()) result.push_back(c.kind);
  return result;
}

std::vector<const ComponentInfo*> Catalogue::of_kind(const std::string& kind) const {
  std::vector<const ComponentInfo*> result;
  for (const ComponentInfo& c : components)
    if (c.kind == kind) result.push_back(&c);
  return result;
}

}  // namespace meristem
