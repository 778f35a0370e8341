// Makes components as a scene file would: make<Light>(register_sky, R"({ "elevation": 20 })").
#pragma once

#include "renderer/language/jsonc_reader.h"
#include "renderer/scene/interfaces.h"

#include <memory>
#include <string>

namespace meristem {

// The one component that `register_component` adds, with the parameters in `text`, prepared for rendering, as if
// `file` said so. Throws
// SceneErrors if anything is wrong.
template <class Interface>
std::unique_ptr<Interface> make(void (*register_component)(Registry<Interface>&), const std::string& text = "{}",
                                const std::string& file = "test") {
  Registry<Interface> registry("component");
  register_component(registry);
  Diagnostics diagnostics;
  const Value value = read_jsonc(std::make_shared<SourceText>(SourceText{file, text}), diagnostics);
  std::unique_ptr<Interface> component = registry.create(value, registry.names().front(), diagnostics);
  diagnostics.throw_if_errors();
  if constexpr (requires { component->prepare(); }) component->prepare();
  return component;
}

}  // namespace meristem
