#include "procedural/growth/growth_symbols.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>

namespace meristem {

namespace {

constexpr int most_symbols = std::numeric_limits<decltype(FaceOrigin::symbol)>::max();

}  // namespace

int GrowthSymbols::find(std::string_view name) const {
  for (std::size_t i = 0; i < entries_.size(); ++i)
    if (entries_[i].name == name) return int(i);
  return -1;
}

int GrowthSymbols::use(const std::string& name, int parameter_count, const Location& where, Diagnostics& diagnostics) {
  const int known = find(name);
  if (known < 0) {
    if (parameter_count > max_growth_parameters) {
      diagnostics.error(where, fmt::format("symbol \"{}\" has {} parameters; at most {} are possible", name,
                                           parameter_count, max_growth_parameters));
      return -1;
    }
    if (size() == most_symbols) {
      diagnostics.error(where, fmt::format("a model has at most {} symbols", most_symbols));
      return -1;
    }
    entries_.push_back({name, parameter_count, where});
    return size() - 1;
  }
  const Entry& e = entry(known);
  if (e.parameter_count == parameter_count) return known;
  diagnostics.error(where,
                    fmt::format("symbol \"{}\" has {} parameter{} here, but {} in line {}", name, parameter_count,
                                parameter_count == 1 ? "" : "s", e.parameter_count, e.first.line()));
  return -1;
}

void GrowthSymbols::add_rule(int symbol, int step) {
  Entry& e = entries_[std::size_t(symbol)];
  e.last_rule = std::max(e.last_rule, step);
  e.has_rule = true;
}

std::vector<std::string> GrowthSymbols::names(bool with_rules) const {
  std::vector<std::string> names;
  for (const Entry& e : entries_)
    if (e.has_rule == with_rules) names.push_back(e.name);
  return names;
}

void GrowthSymbols::report_terminals(Diagnostics& diagnostics) const {
  const std::vector<std::string> with_rules = names(true);
  for (const Entry& e : entries_) {
    if (e.has_rule) continue;
    const std::string_view near = nearest_name(e.name, with_rules);
    if (near.empty()) continue;
    diagnostics.warning(e.first,
                        fmt::format("symbol \"{}\" has no rule in any step; did you mean \"{}\"?", e.name, near));
  }
}

void GrowthSymbols::report_unreachable(Diagnostics& diagnostics) const {
  std::vector<bool> is_reached(entries_.size(), false);
  std::vector<int> open;
  const auto reach = [&](int symbol) {
    if (!is_reached[std::size_t(symbol)]) open.push_back(symbol);
    is_reached[std::size_t(symbol)] = true;
  };
  const auto follow = [&] {
    while (!open.empty()) {
      const Entry& e = entry(open.back());
      open.pop_back();
      for (const int made : e.makes) reach(made);
    }
  };
  for (int s = 0; s < size(); ++s)
    if (entry(s).is_on_base) reach(s);
  follow();
  const auto is_made = [&](int symbol) {  // by a rule of another that is not reached
    for (int other = 0; other < size(); ++other)
      if (other != symbol && !is_reached[std::size_t(other)] &&
          std::ranges::find(entry(other).makes, symbol) != entry(other).makes.end())
        return true;
    return false;
  };
  const std::vector<std::string> terminals = names(false), heads = names(true);
  // What stands at the beginning of a chain first; of a ring any
  for (const bool beginnings : {true, false})
    for (int s = 0; s < size(); ++s) {
      if (is_reached[std::size_t(s)] || (beginnings && is_made(s))) continue;
      reach(s);
      follow();
      // A terminal with a name like it has been reported
      if (!entry(s).has_rule || !nearest_name(entry(s).name, terminals).empty()) continue;
      std::vector<std::string> others;
      std::ranges::copy_if(heads, std::back_inserter(others), [&](const auto& h) { return h != entry(s).name; });
      const std::string_view near = nearest_name(entry(s).name, others);
      diagnostics.warning(
          entry(s).first,
          fmt::format("no face ever carries \"{}\": neither the base nor a rule that is reached makes it{}",
                      entry(s).name, near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near)));
    }
}

namespace {

bool is_name_start(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool is_name_part(char c) { return is_name_start(c) || std::isdigit(static_cast<unsigned char>(c)); }
bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

std::size_t skip_space(std::string_view text, std::size_t i) {
  while (i < text.size() && is_space(text[i])) ++i;
  return i;
}

// Reads arguments from just behind the opening parenthesis at `i` to just behind the closing one; npos if that is
// missing.
std::size_t parse_arguments(std::string_view text, std::size_t i, std::vector<SymbolText::Argument>& arguments) {
  int depth = 0;
  std::size_t begin = i;
  for (; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '(' || c == '[') ++depth;
    if (depth == 0 && (c == ',' || c == ')')) {
      begin = std::min(skip_space(text, begin), i);
      arguments.push_back({std::string(text.substr(begin, i - begin)), begin});
      begin = i + 1;
      if (c == ')') return i + 1;
    }
    if (c == ')' || c == ']') --depth;
  }
  return std::string_view::npos;
}

bool is_blank(const std::string& text) { return skip_space(text, 0) == text.size(); }

}  // namespace

std::optional<SymbolText> parse_symbol_text(std::string_view text, const Location& start, Diagnostics& diagnostics) {
  const auto fail = [&](std::size_t at, const char* message) {
    diagnostics.error(start.advanced(at), message);
    return std::nullopt;
  };
  SymbolText result;
  std::size_t i = skip_space(text, 0);
  if (i == text.size() || !is_name_start(text[i]))
    return fail(i, "expected the name of a symbol, such as \"shoot(1)\"");
  const std::size_t name_begin = i;
  while (i < text.size() && is_name_part(text[i])) ++i;
  result.name = std::string(text.substr(name_begin, i - name_begin));
  i = skip_space(text, i);
  if (i == text.size()) return result;
  if (text[i] != '(') return fail(i, "expected \"(\" or the end of the text behind a symbol's name");
  i = parse_arguments(text, i + 1, result.arguments);
  if (i == std::string_view::npos) return fail(text.size(), "expected \")\"");
  i = skip_space(text, i);
  if (i != text.size()) return fail(i, "expected the end of the text behind a symbol's parameters");
  if (result.arguments.size() == 1 && is_blank(result.arguments[0].text)) result.arguments.clear();
  for (const SymbolText::Argument& a : result.arguments)
    if (is_blank(a.text)) return fail(a.offset, "a parameter is missing here");
  return result;
}

std::shared_ptr<const Expression> compile_at(const std::string& text, const Location& start, const Symbols& variables,
                                             ValueType wanted, Diagnostics& diagnostics) {
  try {
    return Expression::compile(text, variables, wanted);
  } catch (const ExpressionError& e) {
    diagnostics.error(start.advanced(e.offset), e.what());
    return nullptr;
  }
}

Successor::Successor(const std::string& text, const Location& quote, const Symbols& variables, GrowthSymbols& symbols,
                     Diagnostics& diagnostics) {
  if (is_blank(text)) return;
  const Location start = quote.advanced(1);
  const auto parsed = parse_symbol_text(text, start, diagnostics);
  if (!parsed) return;
  for (const SymbolText::Argument& a : parsed->arguments)
    arguments_.push_back(compile_at(a.text, start.advanced(a.offset), variables, ValueType::Scalar, diagnostics));
  symbol_ = symbols.use(parsed->name, int(arguments_.size()), start, diagnostics);
  for (const auto& a : arguments_)
    if (!a) symbol_ = -1;
}

bool Successor::uses(int slot) const {
  return std::any_of(arguments_.begin(), arguments_.end(), [&](const auto& a) { return a && a->uses(slot); });
}

void Successor::evaluate(std::span<const Vec3f> values, Key key, Key salt, FaceOrigin& origin) const {
  origin.symbol = std::int16_t(symbol_);
  origin.parameters = {};
  if (symbol_ < 0) return;
  for (std::size_t i = 0; i < arguments_.size(); ++i) {
    const float value = arguments_[i]->evaluate_scalar(values, key, hash_keys(salt, i));
    if (std::isnan(value)) {
      origin.symbol = -1;
      origin.parameters = {};
      return;
    }
    origin.parameters[i] = value;
  }
}

std::array<Interval, max_growth_parameters> Successor::bounds(std::span<const IntervalValue> values) const {
  std::array<Interval, max_growth_parameters> result{};
  for (std::size_t i = 0; i < arguments_.size(); ++i) result[i] = arguments_[i]->evaluate_bounds(values).x;
  return result;
}

}  // namespace meristem
