#include "renderer/loading/step_counts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

// Where the model says how often its steps are repeated, in their order.
std::vector<Value*> repetitions(Value& model) {
  std::vector<Value*> found;
  for (Member& member : model.members) {
    if (member.key != "steps") continue;
    for (Value& step : member.value.items)
      for (Member& m : step.members)
        if ((m.key == "subdivide" || m.key == "grow") && m.value.kind == Value::Kind::Number) found.push_back(&m.value);
  }
  return found;
}

}  // namespace

std::vector<int> read_step_counts(Params& params) {
  const Value* list = params.raw("counts", false, R"({"type": "array", "items": {"type": "integer", "minimum": 0}})",
                                 "how often the model's steps are repeated, in their order; by default as they say");
  std::vector<int> counts;
  if (!list) return counts;
  const auto is_count = [](const Value& v) {
    return v.kind == Value::Kind::Number && v.number >= 0 && v.number < 1000 && v.number == std::floor(v.number);
  };
  if (list->kind != Value::Kind::Array || !std::all_of(list->items.begin(), list->items.end(), is_count))
    params.error("counts", "\"counts\" is an array of whole numbers, one for each of the model's first steps");
  else
    for (const Value& item : list->items) counts.push_back(int(item.number));
  return counts;
}

std::optional<Value> with_step_counts(const Value& model, const std::vector<int>& counts, Params& params) {
  Value changed = model;
  const std::vector<Value*> numbers = repetitions(changed);
  if (counts.size() > numbers.size()) {
    params.error("counts",
                 fmt::format("the model has {} steps; \"counts\" has {} numbers", numbers.size(), counts.size()));
    return std::nullopt;
  }
  for (std::size_t i = 0; i < counts.size(); ++i) numbers[i]->number = counts[i];
  return changed;
}

}  // namespace meristem
