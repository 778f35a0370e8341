#include "renderer/interchange/pbrt_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace meristem {

PbrtParameters::PbrtParameters(PbrtTokens& tokens, Diagnostics& diagnostics) : diagnostics_(diagnostics) {
  while (tokens.peek().kind == PbrtToken::Kind::Text) {
    const PbrtToken declaration = tokens.next();
    PbrtParameter p;
    p.where = declaration.where;
    const std::string_view text = declaration.text;
    const std::size_t first = std::min(text.find_first_not_of(' '), text.size());
    const std::size_t end = std::min(text.find_first_of(" \t", first), text.size());
    const std::size_t name = std::min(text.find_first_not_of(" \t", end), text.size());
    p.type = text.substr(first, end - first);
    p.name = text.substr(name, text.find_last_not_of(" \t") + 1 - name);
    if (p.name.empty()) diagnostics_.error(p.where, "a parameter is declared by its type and name: \"float fov\"");
    read_values(tokens, p);
    list_.push_back(std::move(p));
  }
}

void PbrtParameters::read_values(PbrtTokens& tokens, PbrtParameter& parameter) {
  if (tokens.peek().kind != PbrtToken::Kind::Open) {
    if (tokens.peek().kind == PbrtToken::Kind::End)
      return diagnostics_.error(parameter.where, "the parameter has no value");
    return add_value(tokens.next(), parameter);
  }
  tokens.next();
  for (;;) {
    const PbrtToken token = tokens.next();
    if (token.kind == PbrtToken::Kind::Close) return;
    if (token.kind == PbrtToken::Kind::End || token.kind == PbrtToken::Kind::Open)
      return diagnostics_.error(parameter.where, "the list of values has no closing bracket");
    const std::size_t found_before = diagnostics_.found();
    add_value(token, parameter);
    if (diagnostics_.found() > found_before) {  // one message a list
      while (tokens.peek().kind != PbrtToken::Kind::Close && tokens.peek().kind != PbrtToken::Kind::End) tokens.next();
    }
  }
}

void PbrtParameters::add_value(const PbrtToken& token, PbrtParameter& parameter) {
  if (token.kind == PbrtToken::Kind::Text && parameter.type != "bool") {
    parameter.texts.emplace_back(token.text);
    return;
  }
  if (token.text == "true" || token.text == "false") {
    parameter.booleans.push_back(token.text == "true");
    return;
  }
  double number = 0;
  const char* begin = token.text.data() + (token.text.starts_with('+') ? 1 : 0);
  const auto [next, code] = std::from_chars(begin, token.text.data() + token.text.size(), number);
  if (token.kind != PbrtToken::Kind::Word || code != std::errc{} || next != token.text.data() + token.text.size() ||
      !std::isfinite(number))
    return diagnostics_.error(token.where, fmt::format("expected a value, found \"{}\"", token.text));
  parameter.numbers.push_back(number);
}

const PbrtParameter* PbrtParameters::find(std::string_view name) {
  const auto p = std::ranges::find(list_, name, &PbrtParameter::name);
  if (p == list_.end()) return nullptr;
  p->is_used = true;
  return &*p;
}

double PbrtParameters::number(std::string_view name, double fallback) {
  const PbrtParameter* p = find(name);
  return p && p->numbers.size() == 1 ? p->numbers[0] : fallback;
}

bool PbrtParameters::boolean(std::string_view name, bool fallback) {
  const PbrtParameter* p = find(name);
  return p && p->booleans.size() == 1 ? p->booleans[0] : fallback;
}

std::string PbrtParameters::text(std::string_view name, const std::string& fallback) {
  const PbrtParameter* p = find(name);
  return p && p->texts.size() == 1 ? p->texts[0] : fallback;
}

std::vector<Vec3d> PbrtParameters::points(std::string_view name) {
  const PbrtParameter* p = find(name);
  if (!p) return {};
  if (p->numbers.size() % 3 != 0) diagnostics_.error(p->where, "expected three numbers for each point");
  std::vector<Vec3d> points;
  for (std::size_t i = 0; i + 3 <= p->numbers.size(); i += 3)
    points.push_back({p->numbers[i], p->numbers[i + 1], p->numbers[i + 2]});
  return points;
}

std::vector<Vec2d> PbrtParameters::pairs(std::string_view name) {
  const PbrtParameter* p = find(name);
  if (!p) return {};
  if (p->numbers.size() % 2 != 0) diagnostics_.error(p->where, "expected pairs of numbers");
  std::vector<Vec2d> pairs;
  for (std::size_t i = 0; i + 2 <= p->numbers.size(); i += 2) pairs.push_back({p->numbers[i], p->numbers[i + 1]});
  return pairs;
}

std::vector<std::uint32_t> PbrtParameters::indices(std::string_view name, std::size_t vertices) {
  const PbrtParameter* p = find(name);
  std::vector<std::uint32_t> indices;
  for (const double n : p ? p->numbers : std::vector<double>{}) {
    if (!(n >= 0 && n < double(vertices) && n == std::floor(n))) {
      diagnostics_.error(p->where, fmt::format("there is no vertex {}; there are {}, from 0 on", n, vertices));
      return {};
    }
    indices.push_back(std::uint32_t(n));
  }
  return indices;
}

}  // namespace meristem
