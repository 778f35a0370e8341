// Where in the user's text something stands, and the errors that point there.
// Loading collects errors in Diagnostics and goes on, so that one pass shows all of them; SceneErrors is thrown once at
// its end and caught once, in the command line (exit code 2) or a binding. Not thread-safe: loading is one thread.
#pragma once

#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace meristem {

// A text as read: a scene file, or what stands in for one (standard input, a command line option).
struct SourceText {
  std::string name;  // as the user wrote it
  std::string text;  // UTF-8
};

// A byte offset in a SourceText. A default-constructed Location points nowhere (things made in code).
struct Location {
  std::shared_ptr<const SourceText> source;
  std::size_t offset = 0;

  int line() const;    // from 1; 0 if nowhere
  int column() const;  // from 1, in bytes; 0 if nowhere
  // The place n bytes further on: for errors inside a string (escapes are not counted).
  Location advanced(std::size_t n) const { return {source, offset + n}; }
};

struct Diagnostic {
  enum class Severity { Error, Warning };
  Severity severity = Severity::Error;
  Location location;
  std::string message;  // what is wrong and what would have been right; no final full stop

  // "scene.jsonc:41:9: error: message", the line itself, and a caret below the place.
  std::string formatted() const;
};

class SceneErrors : public std::runtime_error {
 public:
  explicit SceneErrors(std::vector<Diagnostic> list);
  const std::vector<Diagnostic>& list() const { return list_; }

 private:
  std::vector<Diagnostic> list_;
};

class Diagnostics {
 public:
  // Both say what is found again at the same place once, and list no more than some hundred.
  void error(const Location& where, std::string message);
  void warning(const Location& where, std::string message);
  bool has_errors() const;
  // How many were found so far, listed or not.
  std::size_t errors_found() const { return errors_found_; }
  std::size_t found() const { return errors_found_ + warnings_found_; }
  const std::vector<Diagnostic>& list() const { return list_; }
  // Throws SceneErrors with the whole list, sorted by place, if it holds an error.
  void throw_if_errors() const;

 private:
  bool is_said(Diagnostic::Severity severity, const Location& where, const std::string& message) const;

  std::vector<Diagnostic> list_;
  std::size_t errors_found_ = 0, warnings_found_ = 0;
};

// The candidate nearest to word by edit distance, or an empty view when none is near (more than a third of its letters
// differ). The result points into the candidates, so they must not be a temporary.
std::string_view nearest_name(std::string_view word, const std::vector<std::string>& candidates);
std::string_view nearest_name(std::string_view word, const std::vector<std::string>&& candidates) = delete;

}  // namespace meristem
