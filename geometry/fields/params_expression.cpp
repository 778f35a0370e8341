// The reading functions of Params that need the expression language, which lies above geometry/base.
#include "geometry/base/params.h"

#include "geometry/base/check.h"
#include "geometry/fields/expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

using Compiled = std::shared_ptr<const Expression>;

std::string default_text_of(const char* fallback) {
  const bool bare = std::string_view(fallback).find_first_not_of("0123456789.") == std::string_view::npos;
  return bare ? fallback : fmt::format("\"{}\"", fallback);
}

Compiled compile_fallback(const char* fallback, const Symbols& symbols, ValueType wanted) {
  try {
    return Expression::compile(fallback, symbols, wanted);
  } catch (const ExpressionError& e) {
    CHECK(false, "the default \"{}\" does not compile: {}", fallback, e.what());
  }
  return nullptr;
}

// The expression written in `value`, or null after reporting what is wrong with it.
Compiled compile_text(const Value& value, const Symbols& symbols, ValueType wanted, Diagnostics& diagnostics) {
  try {
    return Expression::compile(value.text, symbols, wanted);
  } catch (const ExpressionError& e) {
    diagnostics.error(text_location(value, e.offset), e.what());
    return nullptr;
  }
}

// A number as the expression language writes it; finite.
std::string written(double number) { return fmt::format("{:.17g}", number); }

bool is_scalar(const Value& v) {
  return v.kind == Value::Kind::Text || (v.kind == Value::Kind::Number && std::isfinite(v.number));
}

bool is_triple(const Value& v) {
  return v.kind == Value::Kind::Array && v.items.size() == 3 && std::all_of(v.items.begin(), v.items.end(), is_scalar);
}

// [x, y, z], each a number or an expression of its own: checked one by one, so that errors point into the right one.
Compiled compile_triple(const Value& value, const Symbols& symbols, Diagnostics& diagnostics) {
  bool good = true;
  std::vector<std::string> parts;
  for (const Value& item : value.items) {
    if (item.kind == Value::Kind::Text) good = compile_text(item, symbols, ValueType::Scalar, diagnostics) && good;
    parts.push_back(item.kind == Value::Kind::Text ? "(" + item.text + ")" : written(item.number));
  }
  if (!good) return nullptr;
  try {
    return Expression::compile(fmt::format("[{}]", fmt::join(parts, ", ")), symbols, ValueType::Vector);
  } catch (const ExpressionError&) {  // each part alone is right, so it holds what only a whole expression may
    diagnostics.error(value.location,
                      "assignments cannot stand inside [x, y, z]; write one expression: \"a = ...; [a, a, a]\"");
    return nullptr;
  }
}

Value number(float x, const Location& where) {
  Value value;
  value.kind = Value::Kind::Number;
  value.number = double(x);
  value.location = where;
  return value;
}

}  // namespace

const Value* Params::now(const Value& value, int components, Value& storage) {
  const Symbols no_variables;
  const auto is_text = [](const Value& v) { return v.kind == Value::Kind::Text; };
  if (is_text(value)) {
    const ValueType wanted = components == 1 ? ValueType::Scalar : ValueType::Vector;
    const Compiled expression = compile_text(value, no_variables, wanted, *diagnostics_);
    if (!expression) return nullptr;
    if (components == 1) {
      storage = number(expression->evaluate_scalar({}), value.location);
      return &storage;
    }
    const Vec3f v = expression->evaluate_vector({});
    storage.kind = Value::Kind::Array;
    storage.location = value.location;
    for (int i = 0; i < 3; ++i) storage.items.push_back(number(v[i], value.location));
    return &storage;
  }
  if (value.kind != Value::Kind::Array || std::none_of(value.items.begin(), value.items.end(), is_text)) return &value;
  storage = value;
  for (Value& item : storage.items) {
    if (!is_text(item)) continue;
    const Compiled expression = compile_text(item, no_variables, ValueType::Scalar, *diagnostics_);
    if (!expression) return nullptr;
    item = number(expression->evaluate_scalar({}), item.location);
  }
  return &storage;
}

Compiled Params::scalar_expression(const char* name, const char* fallback, const Symbols& symbols, const char* doc) {
  const Value* const v = take(
      {.name = name, .type = ParamInfo::Type::ScalarExpression, .default_text = default_text_of(fallback), .doc = doc});
  Compiled result;
  if (v && v->kind == Value::Kind::Text)
    result = compile_text(*v, symbols, ValueType::Scalar, *diagnostics_);
  else if (v && is_scalar(*v))
    result = Expression::compile(written(v->number), symbols, ValueType::Scalar);
  else if (v)
    mismatch(name, *v, "a number or an expression as text");
  return result ? result : compile_fallback(fallback, symbols, ValueType::Scalar);
}

Compiled Params::vector_expression(const char* name, const char* fallback, const Symbols& symbols, const char* doc) {
  const Value* const v = take(
      {.name = name, .type = ParamInfo::Type::VectorExpression, .default_text = default_text_of(fallback), .doc = doc});
  Compiled result;
  if (v && v->kind == Value::Kind::Text)
    result = compile_text(*v, symbols, ValueType::Vector, *diagnostics_);
  else if (v && is_scalar(*v))
    result = Expression::compile(written(v->number), symbols, ValueType::Vector);
  else if (v && is_triple(*v))
    result = compile_triple(*v, symbols, *diagnostics_);
  else if (v)
    mismatch(name, *v, "an expression as text, a number, or three of them as [x, y, z]");
  return result ? result : compile_fallback(fallback, symbols, ValueType::Vector);
}

}  // namespace meristem
