// Lexer: the tokens of an expression, one at a time. The text must outlive it.
#pragma once

#include <cstddef>
#include <string_view>

namespace meristem {

struct Token {
  enum class Kind { End, Number, Name, Symbol, Text };
  Kind kind = Kind::End;
  std::string_view text;  // of a Name without its $; of a Symbol one or two characters; of a Text what stands
                          // between its quotes
  float number = 0;
  std::size_t offset = 0, length = 0;

  bool is(std::string_view symbol) const { return kind == Kind::Symbol && text == symbol; }
  bool is_word(std::string_view word) const { return kind == Kind::Name && text == word; }
};

class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {}
  // The next token. Throws ExpressionError at a character that begins none, at a number beyond the float range and at a
  // text without an end.
  Token next();
  std::size_t position() const { return position_; }
  void seek(std::size_t position) { position_ = position; }

 private:
  void skip_blanks();
  std::size_t end_of_name(std::size_t from) const;
  Token number();
  Token quoted();

  std::string_view text_;
  std::size_t position_ = 0;
};

}  // namespace meristem
