// Catalogue: every component there is, with its parameters: what the schema and the manual pages are made of.
#pragma once

#include "geometry/base/registry.h"

#include <map>
#include <string>
#include <vector>

namespace meristem {

// Kinds whose components are named by a member "type": camera, light, material, integrator, sampler, filter, base.
// Kinds of other shapes:
//   step, model, grid
//               recognised by a member of the component's own name: { "subdivide": 2 }, { "scatter": [...] }
//   template    named by a member "template", beside the members of the production it stands in
//   production  one component; its objects hold a template's members as well
//   section     an object of the scene file without a type: object, render
struct Catalogue {
  std::vector<ComponentInfo> components;
  std::map<std::string, std::string>
      default_types;  // kind -> the type that stands when none is written: camera -> pinhole

  // In the order of `components`, each once.
  std::vector<std::string> kinds() const;
  std::vector<const ComponentInfo*> of_kind(const std::string& kind) const;
};

}  // namespace meristem
