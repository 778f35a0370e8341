// Registry<Interface>: the components of one kind, by name. A component is one file that ends with
//
//   void register_sky(LightRegistry& r) { r.add<Sky>("sky", "The sun and a clear sky over flat ground"); }
//
// and whose constructor takes Params&. cmake/components.cmake globs the folder and generates the function that calls
// every register_<file>(), so a new file is picked up at the next build with no other edit.
// Filled once at start-up, then read-only: any thread may read.
#pragma once

#include "geometry/base/params.h"

#include <fmt/format.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace meristem {

struct ComponentInfo {
  std::string kind;  // "light", "material", ...
  std::string name;  // what "type" says in a scene file
  std::string doc;   // the first line of its manual page
  std::function<std::vector<ParamInfo>()> describe;
};

template <class Interface>
class Registry {
 public:
  // `takes_time`: numbers of the components may be written as expressions of `time`.
  explicit Registry(std::string kind, bool takes_time = false) : kind_(std::move(kind)), takes_time_(takes_time) {}

  template <class T>
  void add(const char* name, const char* doc) {
    entries_.push_back({{kind_, name, doc,
                         [takes_time = takes_time_] {
                           std::vector<ParamInfo> infos;
                           Params params(infos);
                           if (takes_time) params.allow_time();
                           T component(params);
                           return infos;
                         }},
                        [](Params& params) -> std::unique_ptr<Interface> { return std::make_unique<T>(params); }});
  }

  const std::string& kind() const { return kind_; }
  std::vector<std::string> names() const {
    std::vector<std::string> result;
    for (const Entry& e : entries_) result.push_back(e.info.name);
    return result;
  }
  std::vector<ComponentInfo> infos() const {
    std::vector<ComponentInfo> result;
    for (const Entry& e : entries_) result.push_back(e.info);
    return result;
  }

  // Makes the component that the object's member "type" names (`fallback_type` when absent; empty: required).
  // Errors (not an object, unknown type, unknown keys) go to diagnostics; then the result may be nullptr.
  std::unique_ptr<Interface> create(const Value& value, const std::string& fallback_type,
                                    Diagnostics& diagnostics) const {
    if (value.kind != Value::Kind::Object) {
      diagnostics.error(value.location, fmt::format("expected a {} as an object, found {}", kind_, value.kind_name()));
      return nullptr;
    }
    const Value* type = value.find("type");
    if (type && type->kind != Value::Kind::Text) {
      diagnostics.error(type->location,
                        fmt::format("\"type\" names a {}: expected text, found {}", kind_, type->kind_name()));
      return nullptr;
    }
    if (!type && fallback_type.empty()) {
      diagnostics.error(value.location,
                        fmt::format("a {} needs a \"type\"; known: {}", kind_, fmt::join(names(), ", ")));
      return nullptr;
    }
    const std::string name = type ? type->text : fallback_type;
    for (const Entry& e : entries_) {
      if (e.info.name != name) continue;
      Params params(value, fmt::format("{} \"{}\"", kind_, name), diagnostics);
      params.raw("type", false, "", "");  // known to every component
      if (takes_time_) params.allow_time();
      std::unique_ptr<Interface> component = e.make(params);
      params.finish();
      return component;
    }
    const std::vector<std::string> known = names();
    const std::string_view near = nearest_name(name, known);
    diagnostics.error(
        type ? type->location : value.location,
        fmt::format("no {} named \"{}\"{}; known: {}", kind_, name,
                    near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near), fmt::join(known, ", ")));
    return nullptr;
  }

 private:
  struct Entry {
    ComponentInfo info;
    std::function<std::unique_ptr<Interface>(Params&)> make;
  };
  std::string kind_;
  bool takes_time_;
  std::vector<Entry> entries_;
};

}  // namespace meristem
