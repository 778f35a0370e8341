#include "geometry/base/params.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (c == '\n')
      result += "\\n";
    else
      result += c;
  }
  return result + '"';
}

std::string written(Vec3d v) { return fmt::format("[{}, {}, {}]", v.x, v.y, v.z); }
std::string written_color(Vec3d c) { return c.x == c.y && c.y == c.z ? fmt::format("{}", c.x) : written(c); }

std::string with_unit(std::string text, const Range& range) { return *range.unit ? text + ' ' + range.unit : text; }

bool is_vector(const Value& value) {
  return value.kind == Value::Kind::Array && value.items.size() == 3 &&
         std::all_of(value.items.begin(), value.items.end(),
                     [](const Value& v) { return v.kind == Value::Kind::Number; });
}

// "a number", "a number in deg".
std::string wanted(const char* form, const Range& range) {
  return *range.unit ? fmt::format("{} in {}", form, range.unit) : form;
}

std::string found(const Value& value) {
  if (value.kind == Value::Kind::Array) return fmt::format("an array of {}", value.items.size());
  return value.kind_name();
}

}  // namespace

std::string range_text(const Range& range) {
  const bool below = std::isfinite(range.min), above = std::isfinite(range.max);
  if (below && above) return with_unit(fmt::format("{} to {}", range.min, range.max), range);
  if (below) return with_unit(fmt::format("at least {}", range.min), range);
  if (above) return with_unit(fmt::format("at most {}", range.max), range);
  return {};
}

Params::Params(const Value& value, std::string what, Diagnostics& diagnostics)
    : value_(&value), what_(std::move(what)), diagnostics_(&diagnostics) {
  if (value.kind != Value::Kind::Object)
    diagnostics.error(value.location, fmt::format("{}: expected an object, found {}", what_, found(value)));
}

Params::Params(std::vector<ParamInfo>& infos)
    : unheard_(std::make_shared<Diagnostics>()), diagnostics_(unheard_.get()), infos_(&infos) {}

const Location& Params::location() const {
  static const Location nowhere;
  return describing() ? nowhere : value_->location;
}

bool Params::has(const char* name) const { return value_ && value_->find(name); }

Location Params::location_of(const char* name) const {
  const Value* const member = value_ ? value_->find(name) : nullptr;
  return member ? member->location : location();
}

const Value* Params::take(ParamInfo info) {
  if (describing()) {
    const auto same_name = [&](const ParamInfo& other) { return other.name == info.name; };
    if (std::none_of(infos_->begin(), infos_->end(), same_name)) infos_->push_back(std::move(info));
    return nullptr;
  }
  known_.push_back(info.name);
  const Value* const member = value_->find(info.name);
  if (!member && info.required && value_->kind == Value::Kind::Object)
    diagnostics_->error(value_->location, fmt::format("{} needs {}{}{}", what_, quoted(info.name),
                                                      info.doc.empty() ? "" : ": ", info.doc));
  return member;
}

const Value* Params::take_timed(ParamInfo info, int components, Value& storage) {
  info.takes_time = allows_time_;
  const Value* const v = take(std::move(info));
  return v && allows_time_ ? now(*v, components, storage) : v;
}

void Params::mismatch(const char* name, const Value& value, std::string_view expected) {
  diagnostics_->error(value.location,
                      fmt::format("{} of {}: expected {}, found {}", quoted(name), what_, expected, found(value)));
}

bool Params::accept(const char* name, const Value& value, const Range& range) {
  if (value.kind != Value::Kind::Number) {
    mismatch(name, value, wanted("a number", range));
    return false;
  }
  if (std::isfinite(value.number) && value.number >= range.min && value.number <= range.max) return true;
  diagnostics_->error(value.location, fmt::format("{} of {} is {}; expected {}", quoted(name), what_, value.number,
                                                  std::isfinite(value.number) ? range_text(range) : "a finite number"));
  return false;
}

bool Params::accept_vector(const char* name, const Value& value, const Range& range) {
  bool good = true;
  for (const Value& item : value.items) good = accept(name, item, range) && good;
  return good;
}

double Params::real(const char* name, double fallback, Range range, const char* doc) {
  Value storage;
  const Value* const v = take_timed({.name = name,
                                     .type = ParamInfo::Type::Real,
                                     .range = range,
                                     .default_text = fmt::format("{}", fallback),
                                     .doc = doc},
                                    1, storage);
  return v && accept(name, *v, range) ? v->number : fallback;
}

int Params::integer(const char* name, int fallback, Range range, const char* doc) {
  const Value* const v = take({.name = name,
                               .type = ParamInfo::Type::Integer,
                               .range = range,
                               .default_text = fmt::format("{}", fallback),
                               .doc = doc});
  range.min = std::max(range.min, double(std::numeric_limits<int>::min()));
  range.max = std::min(range.max, double(std::numeric_limits<int>::max()));
  if (!v || !accept(name, *v, range)) return fallback;
  if (v->number == std::floor(v->number)) return int(v->number);
  diagnostics_->error(v->location,
                      fmt::format("{} of {} is {}; expected a whole number", quoted(name), what_, v->number));
  return fallback;
}

bool Params::boolean(const char* name, bool fallback, const char* doc) {
  const Value* const v =
      take({.name = name, .type = ParamInfo::Type::Boolean, .default_text = fallback ? "true" : "false", .doc = doc});
  if (!v) return fallback;
  if (v->kind == Value::Kind::Bool) return v->boolean;
  mismatch(name, *v, "true or false");
  return fallback;
}

std::string Params::text(const char* name, const char* fallback, const char* doc) {
  const Value* const v =
      take({.name = name, .type = ParamInfo::Type::Text, .default_text = quoted(fallback), .doc = doc});
  if (!v) return fallback;
  if (v->kind == Value::Kind::Text) return v->text;
  mismatch(name, *v, "text");
  return fallback;
}

int Params::choice(const char* name, int fallback, const std::vector<std::string>& names, const char* doc) {
  const Value* const v = take({.name = name,
                               .type = ParamInfo::Type::Choice,
                               .default_text = quoted(names.at(std::size_t(fallback))),
                               .choices = names,
                               .doc = doc});
  if (!v) return fallback;
  if (v->kind != Value::Kind::Text) {
    mismatch(name, *v, fmt::format("one of \"{}\"", fmt::join(names, "\", \"")));
    return fallback;
  }
  const auto chosen = std::find(names.begin(), names.end(), v->text);
  if (chosen != names.end()) return int(chosen - names.begin());
  const std::string_view near = nearest_name(v->text, names);
  diagnostics_->error(
      v->location,
      fmt::format("{} of {} has no choice {}{}; known: {}", quoted(name), what_, quoted(v->text),
                  near.empty() ? "" : fmt::format("; did you mean {}?", quoted(near)), fmt::join(names, ", ")));
  return fallback;
}

Vec3d Params::read_vector(const char* name, const Value* value, Vec3d fallback, const Range& range) {
  if (!value) return fallback;
  if (!is_vector(*value)) {
    mismatch(name, *value, wanted("three numbers [x, y, z]", range));
    return fallback;
  }
  if (!accept_vector(name, *value, range)) return fallback;
  return {value->items[0].number, value->items[1].number, value->items[2].number};
}

Vec3d Params::vector(const char* name, Vec3d fallback, Range range, const char* doc) {
  Value storage;
  const Value* const v = take_timed(
      {.name = name, .type = ParamInfo::Type::Vector, .range = range, .default_text = written(fallback), .doc = doc}, 3,
      storage);
  return read_vector(name, v, fallback, range);
}

Vec3d Params::color(const char* name, Vec3d fallback, const char* doc) {
  Value storage;
  const Value* const v = take_timed({.name = name,
                                     .type = ParamInfo::Type::Color,
                                     .range = not_negative,
                                     .default_text = written_color(fallback),
                                     .doc = doc},
                                    3, storage);
  if (!v) return fallback;
  if (v->kind == Value::Kind::Number) return accept(name, *v, not_negative) ? Vec3d(v->number) : fallback;
  if (is_vector(*v)) return read_vector(name, v, fallback, not_negative);
  mismatch(name, *v, "a colour: [red, green, blue] or one number for grey");
  return fallback;
}

double Params::required_real(const char* name, Range range, const char* doc) {
  Value storage;
  const Value* const v = take_timed(
      {.name = name, .type = ParamInfo::Type::Real, .range = range, .required = true, .doc = doc}, 1, storage);
  return v && accept(name, *v, range) ? v->number : std::clamp(1.0, range.min, range.max);
}

Vec3d Params::required_vector(const char* name, const char* doc) {
  Value storage;
  const Value* const v =
      take_timed({.name = name, .type = ParamInfo::Type::Vector, .required = true, .doc = doc}, 3, storage);
  return read_vector(name, v, {}, any_range);
}

std::string Params::required_text(const char* name, const char* doc) {
  const Value* const v = take({.name = name, .type = ParamInfo::Type::Text, .required = true, .doc = doc});
  if (!v) return {};
  if (v->kind == Value::Kind::Text) return v->text;
  mismatch(name, *v, "text");
  return {};
}

const Value* Params::raw(const char* name, bool required, const char* schema, const char* doc) {
  return take({.name = name, .type = ParamInfo::Type::Raw, .required = required, .schema = schema, .doc = doc});
}

void Params::finish() {
  if (describing()) return;
  for (const Member& member : value_->members) {
    if (std::find(known_.begin(), known_.end(), member.key) != known_.end()) continue;
    const std::string_view near = nearest_name(member.key, known_);
    diagnostics_->error(member.key_location,
                        fmt::format("{} has no {}; {}", what_, quoted(member.key),
                                    near.empty() ? fmt::format("known: {}", fmt::join(known_, ", "))
                                                 : fmt::format("did you mean {}?", quoted(near))));
  }
}

}  // namespace meristem
