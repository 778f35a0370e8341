#include "geometry/base/source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <functional>

namespace meristem {

namespace {

constexpr std::size_t max_diagnostics = 200;  // a file of nothing but mistakes must not fill memory or the terminal
constexpr std::size_t shown_width =
    100;  // bytes of the line shown around the place, so that one-line files stay readable

std::size_t clamped_offset(const Location& where) { return std::min(where.offset, where.source->text.size()); }

std::size_t line_start(std::string_view text, std::size_t offset) {
  const std::size_t newline = offset == 0 ? std::string_view::npos : text.rfind('\n', offset - 1);
  return newline == std::string_view::npos ? 0 : newline + 1;
}

bool is_continuation(char c) { return (std::uint8_t(c) & 0xc0) == 0x80; }

// Text for a terminal: control characters would let a file move the cursor or hide its own errors.
std::string printable(std::string_view text) {
  std::string result;
  for (const char c : text) {
    const auto byte = std::uint8_t(c);
    if (byte == '\t' || (byte >= 0x20 && byte != 0x7f))
      result += c;
    else
      result += fmt::format("\\u{:04x}", byte);
  }
  return result;
}

// The line that holds the place, and a caret below it. Tabs stay tabs, so that the caret stands right for any tab
// width.
std::string excerpt(const Location& where) {
  const std::string_view text = where.source->text;
  const std::size_t offset = clamped_offset(where);
  std::size_t begin = line_start(text, offset);
  std::size_t end = std::min(text.find('\n', offset), text.size());
  if (end > begin && text[end - 1] == '\r' && end - 1 >= offset) --end;

  // Show a window of a long line, cut between characters
  const std::size_t half = shown_width / 2;
  const bool cut_front = offset - begin > half && end - begin > shown_width;
  if (cut_front) begin = offset - half;
  const bool cut_back = end - begin > shown_width;
  if (cut_back) end = begin + shown_width;
  while (begin < offset && is_continuation(text[begin])) ++begin;
  while (end > offset && end < text.size() && is_continuation(text[end])) --end;

  const std::string before = (cut_front ? "..." : "") + printable(text.substr(begin, offset - begin));
  std::string padding;
  for (const char c : before)
    if (!is_continuation(c)) padding += c == '\t' ? '\t' : ' ';
  return fmt::format("  {}{}{}\n  {}^", before, printable(text.substr(offset, end - offset)), cut_back ? "..." : "",
                     padding);
}

bool stands_before(const Diagnostic& a, const Diagnostic& b) {
  const SourceText* const sa = a.location.source.get();
  const SourceText* const sb = b.location.source.get();
  if (sa == sb) return a.location.offset < b.location.offset;
  if (!sa || !sb) return !sa;
  return sa->name < sb->name;
}

std::string all_formatted(const std::vector<Diagnostic>& list) {
  std::string result;
  for (const Diagnostic& d : list) result += (result.empty() ? "" : "\n") + d.formatted();
  return result;
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = char(std::tolower(std::uint8_t(c)));
  return result;
}

// Optimal string alignment: insertions, deletions, replacements and swaps of neighbours (Damerau 1964, each letter
// edited once).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last, last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_last = last;
    last = row;
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

}  // namespace

int Location::line() const {
  if (!source) return 0;
  const auto begin = source->text.begin();
  return 1 + int(std::count(begin, begin + std::ptrdiff_t(clamped_offset(*this)), '\n'));
}

int Location::column() const {
  if (!source) return 0;
  const std::size_t at = clamped_offset(*this);
  return 1 + int(at - line_start(source->text, at));
}

std::string Diagnostic::formatted() const {
  const char* const word = severity == Severity::Error ? "error" : "warning";
  if (!location.source) return fmt::format("{}: {}", word, printable(message));
  return fmt::format("{}:{}:{}: {}: {}\n{}", printable(location.source->name), location.line(), location.column(), word,
                     printable(message), excerpt(location));
}

SceneErrors::SceneErrors(std::vector<Diagnostic> list)
    : std::runtime_error(all_formatted(list)), list_(std::move(list)) {}

// What is found again is not said again: a model is read for each of its seeds.
bool Diagnostics::is_said(Diagnostic::Severity severity, const Location& where, const std::string& message) const {
  return std::ranges::any_of(list_, [&](const Diagnostic& d) {
    return d.severity == severity && d.location.source == where.source && d.location.offset == where.offset &&
           d.message == message;
  });
}

void Diagnostics::error(const Location& where, std::string message) {
  ++errors_found_;
  if (is_said(Diagnostic::Severity::Error, where, message)) return;
  if (list_.size() + 1 == max_diagnostics) message = "too many errors; the others are not listed";
  if (list_.size() < max_diagnostics) list_.push_back({Diagnostic::Severity::Error, where, std::move(message)});
}

void Diagnostics::warning(const Location& where, std::string message) {
  ++warnings_found_;
  if (is_said(Diagnostic::Severity::Warning, where, message)) return;
  // Half of the room is kept for errors, which decide whether the scene is used
  if (list_.size() < max_diagnostics / 2) list_.push_back({Diagnostic::Severity::Warning, where, std::move(message)});
}

bool Diagnostics::has_errors() const {
  return std::any_of(list_.begin(), list_.end(),
                     [](const Diagnostic& d) { return d.severity == Diagnostic::Severity::Error; });
}

void Diagnostics::throw_if_errors() const {
  if (!has_errors()) return;
  std::vector<Diagnostic> sorted = list_;
  std::stable_sort(sorted.begin(), sorted.end(), stands_before);
  throw SceneErrors(std::move(sorted));
}

std::string_view nearest_name(std::string_view word, const std::vector<std::string>& candidates) {
  std::string_view nearest;
  std::size_t smallest = ~std::size_t(0);
  for (const std::string& candidate : candidates) {
    const std::size_t longer = std::max(word.size(), candidate.size());
    const std::size_t shorter = std::min(word.size(), candidate.size());
    if (3 * (longer - shorter) > longer) continue;  // the letters missing alone are too many
    const std::size_t distance = edit_distance(lower_case(word), lower_case(candidate));
    if (3 * distance <= longer && distance < smallest) {
      smallest = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

}  // namespace meristem
