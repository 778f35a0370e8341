#include "geometry/fields/lexer.h"

#include "geometry/fields/expression.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace meristem {

namespace {

// Of ASCII alone: the locale must not matter.
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool begins_name(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

std::string shown(char c) {
  return c >= ' ' && c < 127 ? fmt::format("'{}'", c) : fmt::format("the byte 0x{:02x}", static_cast<unsigned char>(c));
}

}  // namespace

void Lexer::skip_blanks() {
  while (position_ < text_.size()) {
    if (text_[position_] == '#')
      position_ = std::min(text_.find('\n', position_), text_.size());
    else if (is_blank(text_[position_]))
      ++position_;
    else
      return;
  }
}

std::size_t Lexer::end_of_name(std::size_t from) const {
  while (from < text_.size() && (begins_name(text_[from]) || is_digit(text_[from]))) ++from;
  return from;
}

Token Lexer::number() {
  double value = 0;
  const char* begin = text_.data() + position_;
  const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
  const std::size_t length = std::size_t(end - begin);
  // Out of range is also what from_chars calls a number too small for a double: its exponent is negative
  if (error == std::errc::result_out_of_range) {
    const std::string_view written(begin, length);
    value = written.find("e-") != written.npos || written.find("E-") != written.npos ? 0 : HUGE_VAL;
  }
  if (std::abs(value) > double(std::numeric_limits<float>::max()))
    throw ExpressionError("the number is too large; the largest is 3.4e38", position_, length);
  if (value < double(std::numeric_limits<float>::min())) value = 0;  // denormal numbers are 0
  Token t{Token::Kind::Number, text_.substr(position_, length), float(value), position_, length};
  position_ += length;
  return t;
}

// 'text' or "text", without escapes.
Token Lexer::quoted() {
  const std::size_t start = position_, end = text_.find(text_[start], start + 1);
  if (end == text_.npos)
    throw ExpressionError(fmt::format("the text has no end; expected {}", text_[start]), start, text_.size() - start);
  position_ = end + 1;
  return {Token::Kind::Text, text_.substr(start + 1, end - start - 1), 0, start, position_ - start};
}

Token Lexer::next() {
  skip_blanks();
  const std::size_t start = position_;
  if (start >= text_.size()) return {Token::Kind::End, {}, 0, text_.size(), 0};
  const char c = text_[start], after = start + 1 < text_.size() ? text_[start + 1] : '\0';
  if (is_digit(c) || (c == '.' && is_digit(after))) return number();
  if (c == '\'' || c == '"') return quoted();
  const std::size_t name = c == '$' ? start + 1 : start;
  if (name < text_.size() && begins_name(text_[name])) {
    position_ = end_of_name(name);
    return {Token::Kind::Name, text_.substr(name, position_ - name), 0, start, position_ - start};
  }
  static constexpr std::string_view pairs[] = {"==", "!=", "<=", ">=", "&&", "||", "->",
                                               "+=", "-=", "*=", "/=", "%=", "^="};
  std::size_t length = 0;
  for (std::string_view pair : pairs)
    if (text_.substr(start, 2) == pair) length = 2;
  if (length == 0 && std::string_view("+-*/%^!~<>=?:;,()[]{}").find(c) != std::string_view::npos) length = 1;
  if (length == 0) throw ExpressionError(fmt::format("{} has no meaning here", shown(c)), start, 1);
  position_ += length;
  return {Token::Kind::Symbol, text_.substr(start, length), 0, start, length};
}

}  // namespace meristem
