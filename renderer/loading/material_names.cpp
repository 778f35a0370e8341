#include "renderer/loading/material_names.h"

#include <fmt/format.h>

namespace meristem {

MaterialNames MaterialNames::read(Params& params, const Check& check) {
  MaterialNames names;
  names.all_ = params.text("material", "", "of all faces, instead of those that the model names");
  if (!names.all_.empty()) check(names.all_, params.location_of("material"));
  const Value* list =
      params.raw("materials", false, R"({"type": "object", "additionalProperties": {"type": "string"}})",
                 "materials by the names of those of the model whose place they take");
  if (!list) return names;
  if (list->kind != Value::Kind::Object) {
    params.error("materials",
                 fmt::format("\"materials\" is {{\"leaf\": \"dry leaf\", ...}}, found {}", list->kind_name()));
    return names;
  }
  for (const Member& m : list->members) {
    check(m.key, m.key_location);
    if (m.value.kind != Value::Kind::Text)
      params.error("materials", fmt::format("what takes the place of \"{}\" is the name of a material", m.key));
    else
      check(m.value.text, m.value.location);
    names.by_name_[m.key] = m.value.text;
  }
  return names;
}

const std::string& MaterialNames::of(const std::string& name) const {
  const auto own = by_name_.find(name);
  if (own != by_name_.end()) return own->second;
  return all_.empty() ? name : all_;
}

MaterialNames MaterialNames::then(const MaterialNames& outer) const {
  MaterialNames both;
  both.all_ = all_.empty() ? outer.all_ : outer.of(all_);
  for (const auto& [name, own] : by_name_) both.by_name_[name] = outer.of(own);
  if (all_.empty()) both.by_name_.insert(outer.by_name_.begin(), outer.by_name_.end());
  return both;
}

}  // namespace meristem
