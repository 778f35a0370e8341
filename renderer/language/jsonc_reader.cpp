#include "renderer/language/jsonc_reader.h"

#include "renderer/language/utf8.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace meristem {

namespace {

constexpr std::size_t shown_bytes = 40;  // of the user's text inside a message

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '$'; }
// What belongs to a word or number that somebody might write without quotes.
bool is_word(char c) { return is_letter(c) || is_digit(c) || c == '.' || c == '+' || c == '-'; }

std::string shown(std::string_view text) {
  if (text.size() <= shown_bytes) return std::string(text);
  std::size_t end = shown_bytes;
  while (end > 0 && (text[end] & 0xc0) == 0x80) --end;  // not inside a character
  return std::string(text.substr(0, end)) + "...";
}

// Whether a word follows the grammar of numbers in RFC 8259, section 6.
bool is_json_number(std::string_view s) {
  std::size_t i = 0;
  const auto digits = [&] {
    const std::size_t begin = i;
    while (i < s.size() && is_digit(s[i])) ++i;
    return i - begin;
  };
  if (i < s.size() && s[i] == '-') ++i;
  const std::size_t whole_begin = i, whole = digits();
  if (whole == 0 || (whole > 1 && s[whole_begin] == '0')) return false;
  if (i < s.size() && s[i] == '.') {
    ++i;
    if (digits() == 0) return false;
  }
  if (i < s.size() && (s[i] == 'e' || s[i] == 'E')) {
    ++i;
    if (i < s.size() && (s[i] == '+' || s[i] == '-')) ++i;
    if (digits() == 0) return false;
  }
  return i == s.size();
}

// Thrown inside read_jsonc alone, after the error that makes further reading pointless has been reported.
struct Stop {};

class JsoncReader {
 public:
  JsoncReader(std::shared_ptr<const SourceText> source, Diagnostics& diagnostics)
      : source_(std::move(source)), text_(source_->text), diagnostics_(diagnostics) {}

  // Fills `root` as it goes, so that what stands before a Stop is kept.
  void read(Value& root) {
    check_bytes();
    skip_blank();
    if (at_end()) stop(at_, "nothing here; expected a scene: { \"format\": 1, ... }");
    read_value(root);
    skip_blank();
    if (!at_end()) stop(at_, fmt::format("expected the end of the file, found {}", found()));
  }

 private:
  enum class Bracket : char { Array = ']', Object = '}' };

  bool at_end() const { return at_ >= text_.size(); }
  char peek(std::size_t ahead = 0) const { return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0'; }
  Location place(std::size_t offset) const { return {source_, offset}; }
  void error(std::size_t offset, std::string message) { diagnostics_.error(place(offset), std::move(message)); }
  [[noreturn]] void stop(std::size_t offset, std::string message) {
    error(offset, std::move(message));
    throw Stop{};
  }

  // What stands at the place, for messages.
  std::string found() const {
    if (at_end()) return "the end of the file";
    if (is_word(peek())) return fmt::format("\"{}\"", shown(word()));
    if (peek() == '"') return "text";
    std::size_t length = 1;
    while ((peek(length) & 0xc0) == 0x80) ++length;
    return fmt::format("'{}'", text_.substr(at_, length));
  }

  std::string_view word() const {
    std::size_t end = at_;
    while (end < text_.size() && is_word(text_[end])) ++end;
    return text_.substr(at_, end - at_);
  }

  void check_bytes() {
    if (text_.size() > JsoncLimits::file_bytes)
      stop(0, fmt::format("longer than {} MiB", JsoncLimits::file_bytes >> 20));
    const std::size_t bad = find_invalid_utf8(text_);
    if (bad != std::string_view::npos)
      stop(bad, fmt::format("byte 0x{:02x} is not UTF-8; save the file in UTF-8", std::uint8_t(text_[bad])));
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;  // a byte order mark
  }

  void skip_line() { at_ = std::min(text_.find('\n', at_), text_.size()); }

  void skip_block_comment() {
    const std::size_t end = text_.find("*/", at_ + 2);
    if (end == std::string_view::npos) stop(at_, "this comment has no end; expected */");
    at_ = end + 2;
  }

  // White space and comments.
  void skip_blank() {
    for (;;) {
      const char c = peek();
      if (!at_end() && (c == ' ' || c == '\n' || c == '\r' || c == '\t')) {
        ++at_;
      } else if (c == '/' && peek(1) == '/') {
        skip_line();
      } else if (c == '/' && peek(1) == '*') {
        skip_block_comment();
      } else if (c == '#') {
        error(at_, "a comment begins with //");
        skip_line();
      } else {
        return;
      }
    }
  }

  void read_value(Value& value) {
    if (++value_count_ > JsoncLimits::values)
      stop(at_, fmt::format("more than {} values in one file", JsoncLimits::values));
    value.location = place(at_);
    const char c = peek();
    if (at_end()) stop_at_end();
    if (c == '{') return read_object(value);
    if (c == '[') return read_array(value);
    if (c == '"' || c == '\'') return read_text(value);
    if (is_word(c)) return read_word(value);
    error(at_, fmt::format("expected a value, found {}", found()));
    if (c != ',' && c != '}' && c != ']') throw Stop{};
  }

  [[noreturn]] void stop_at_end() {
    if (open_.empty()) stop(at_, "expected a value, found the end of the file");
    const Location begin = place(open_.back());
    const bool object = text_[begin.offset] == '{';
    stop(at_, fmt::format("the file ends inside the {} that begins at line {}, column {}; expected {}",
                          object ? "object" : "array", begin.line(), begin.column(), object ? "'}'" : "']'"));
  }

  void open() {
    if (open_.size() >= std::size_t(JsoncLimits::depth))
      stop(at_, fmt::format("more than {} arrays and objects inside each other", JsoncLimits::depth));
    open_.push_back(at_++);
  }

  void close() {
    open_.pop_back();
    ++at_;
  }

  // After an item that ended at `end`: takes the comma, or reports that it is missing where more follows.
  void read_separator(Bracket bracket, std::size_t end) {
    const char closing = char(bracket);
    if (at_end()) stop_at_end();
    if (peek() == ',') {
      ++at_;
      skip_blank();
    } else if (peek() == '"' || peek() == '\'' || is_word(peek()) || peek() == '{' || peek() == '[') {
      error(end, fmt::format("expected ',' or '{}' after this", closing));
    } else if (peek() != closing) {
      const Location begin = place(open_.back());
      stop(at_, fmt::format("expected ',' or '{}', found {}; the {} begins at line {}, column {}", closing, found(),
                            bracket == Bracket::Object ? "object" : "array", begin.line(), begin.column()));
    }
  }

  void read_array(Value& array) {
    array.kind = Value::Kind::Array;
    open();
    skip_blank();
    while (peek() != ']') {
      read_value(array.items.emplace_back());
      const std::size_t end = at_;
      skip_blank();
      read_separator(Bracket::Array, end);
    }
    close();
  }

  void read_object(Value& object) {
    object.kind = Value::Kind::Object;
    open();
    skip_blank();
    while (peek() != '}') {
      Member& member = object.members.emplace_back();
      read_key(member);
      if (read_colon(member)) read_value(member.value);
      const std::size_t end = at_;
      skip_blank();
      read_separator(Bracket::Object, end);
    }
    close();
    drop_repeated(object);
  }

  void read_key(Member& member) {
    if (at_end()) stop_at_end();
    member.key_location = place(at_);
    if (peek() == '"' || peek() == '\'') {
      member.key = read_string(JsoncLimits::key_bytes);
    } else if (is_letter(peek())) {
      member.key = std::string(word());
      error(at_, fmt::format("expected a key in double quotes: \"{}\"", shown(member.key)));
      at_ += member.key.size();
    } else {
      stop(at_, fmt::format("expected a key in double quotes or '}}', found {}", found()));
    }
  }

  // False if no value follows.
  bool read_colon(const Member& member) {
    const std::size_t end = at_;
    skip_blank();
    if (peek() == ':' || peek() == '=') {
      if (peek() == '=') error(at_, "expected ':', found '='");
      ++at_;
      skip_blank();
      return true;
    }
    error(end, fmt::format("expected ':' and a value after the key \"{}\"", shown(member.key)));
    return peek() != ',' && peek() != '}';
  }

  // Reports keys that stand twice in the object, and keeps the first of each.
  void drop_repeated(Value& object) {
    std::vector<Member>& members = object.members;
    std::vector<std::size_t> order(members.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return members[a].key < members[b].key; });
    std::vector<bool> repeated(members.size(), false);
    bool any = false;
    for (std::size_t i = 1, first = 0; i < order.size(); ++i) {
      if (members[order[i]].key != members[order[first]].key) {
        first = i;
        continue;
      }
      const Location& earlier = members[order[first]].key_location;
      diagnostics_.error(members[order[i]].key_location,
                         fmt::format("the key \"{}\" stands twice; first at line {}, column {}",
                                     shown(members[order[i]].key), earlier.line(), earlier.column()));
      repeated[order[i]] = any = true;
    }
    if (!any) return;
    std::size_t index = 0;
    std::erase_if(members, [&](const Member&) { return repeated[index++]; });
  }

  // true, false, null or a number; else what was meant is guessed for the message.
  void read_word(Value& value) {
    const std::size_t begin = at_;
    const std::string_view w = word();
    at_ += w.size();
    if (w == "true" || w == "false") {
      value.kind = Value::Kind::Bool;
      value.boolean = w == "true";
    } else if (is_digit(w[0]) || w[0] == '-' || w[0] == '+' || w[0] == '.') {
      value.kind = Value::Kind::Number;
      value.number = read_number(w, begin);
    } else if (w != "null") {
      const std::vector<std::string> words{"true", "false", "null"};
      const std::string_view near = nearest_name(w, words);
      error(begin, fmt::format("expected a value, found \"{}\"; {}", shown(w),
                               near.empty() ? "text takes double quotes" : fmt::format("did you mean {}?", near)));
    }
  }

  double read_number(std::string_view w, std::size_t begin) {
    double number = 0;
    if (!is_json_number(w)) {
      error(begin, fmt::format("\"{}\" is not a number; expected one as 12, -0.5 or 1e-3", shown(w)));
    } else if (std::from_chars(w.data(), w.data() + w.size(), number).ec != std::errc{} || !std::isfinite(number)) {
      error(begin, fmt::format("{} is too large or too small for a number", shown(w)));
      number = 0;
    }
    return number;
  }

  void read_text(Value& value) {
    value.kind = Value::Kind::Text;
    value.text = read_string(JsoncLimits::text_bytes);
  }

  std::string read_string(std::size_t limit) {
    const std::size_t begin = at_;
    const char quote = text_[at_++];
    if (quote == '\'') error(begin, "expected double quotes, found '");
    std::string result;
    while (peek() != quote) {
      const auto c = std::uint8_t(peek());
      if (at_end() || c == '\n') stop(begin, "this text has no closing quote on its line");
      if (result.size() >= limit) stop(begin, fmt::format("this text is longer than {} bytes", limit));
      if (c < 0x20) error(at_, fmt::format("a control character in text; write it as \\u{:04x}", c));
      if (c == '\\')
        read_escape(result);
      else
        result += text_[at_++];
    }
    ++at_;
    return result;
  }

  void read_escape(std::string& result) {
    static constexpr std::string_view letters = "\"\\/bfnrt", meanings = "\"\\/\b\f\n\r\t";
    const std::size_t index = peek(1) == '\0' ? std::string_view::npos : letters.find(peek(1));
    if (index != std::string_view::npos) {
      result += meanings[index];
      at_ += 2;
    } else if (peek(1) == 'u') {
      read_unicode_escape(result);
    } else {
      error(at_,
            "unknown escape; expected \\\", \\\\, \\/, \\b, \\f, \\n, \\r, \\t or \\u and four hexadecimal digits");
      at_ += 1;  // what follows the backslash is read as text
    }
  }

  // The four hexadecimal digits of an escape \uXXXX that begins at `offset`.
  std::optional<std::uint32_t> hex_at(std::size_t offset) const {
    if (text_.substr(offset, 2) != "\\u" || offset + 6 > text_.size()) return {};
    std::uint32_t code = 0;
    const char* const end = text_.data() + offset + 6;
    const auto [last, status] = std::from_chars(end - 4, end, code, 16);
    return status == std::errc{} && last == end ? std::optional(code) : std::nullopt;
  }

  void read_unicode_escape(std::string& result) {
    const std::size_t begin = at_;
    const std::optional<std::uint32_t> code = hex_at(at_);
    at_ += code ? 6 : 2;
    if (!code) return error(begin, "expected four hexadecimal digits after \\u");
    if (*code == 0) return error(begin, "text cannot hold the character U+0000");
    if (*code < 0xd800 || *code > 0xdfff) return append_utf8(result, *code);
    const std::optional<std::uint32_t> low = hex_at(at_);
    if (*code > 0xdbff || !low || *low < 0xdc00 || *low > 0xdfff)
      return error(begin, "half of a surrogate pair; write both halves, as in \\ud83c\\udf33, or the character itself");
    at_ += 6;
    append_utf8(result, 0x10000 + ((*code - 0xd800) << 10) + (*low - 0xdc00));
  }

  std::shared_ptr<const SourceText> source_;
  std::string_view text_;
  Diagnostics& diagnostics_;
  std::size_t at_ = 0;
  std::size_t value_count_ = 0;
  std::vector<std::size_t> open_;  // offsets of the brackets we are in
};

}  // namespace

Value read_jsonc(std::shared_ptr<const SourceText> source, Diagnostics& diagnostics) {
  Value root;
  try {
    JsoncReader(std::move(source), diagnostics).read(root);
  } catch (const Stop&) {
    // reported where it was thrown
  }
  return root;
}

}  // namespace meristem
