// How far the render is: a bar with the time left on a terminal, plain lines every few seconds elsewhere (a log keeps
// them), one JSON object a line for programs, nothing when quiet. One thread.
#pragma once

#include "renderer/session/session.h"

#include <cstdio>
#include <string>
#include <tuple>

namespace meristem {

// "1.4 s", "3 min 20 s", "2 h 5 min".
std::string format_duration(double seconds);

// " 43 % [=========>           ] pass 3/4, 12 s, 16 s left"; the bar fills `columns`.
std::string format_bar(const RenderProgress& progress, int columns);
// "43 %, pass 3/4, 12 s, 16 s left"
std::string format_line(const RenderProgress& progress);
// {"event": "progress", "fraction": 0.43, "samples": ..., "samples_total": ..., "pass": 3, "passes": 4,
// "elapsed_s": 12.1, "left_s": 16.0}; left_s is null while it would be a guess.
std::string format_json(const RenderProgress& progress);

class ProgressDisplay {
 public:
  enum class Style { None, Bar, Lines, Json };

  // A bar if `out` is a terminal, else lines.
  static Style style_for(std::FILE* out);

  ProgressDisplay(std::FILE* out, Style style) : out_(out), style_(style) {}
  ~ProgressDisplay() { clear(); }
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  void update(const RenderProgress& progress);
  void clear();  // wipes the bar

 private:
  // Output that cannot be written (a full disk) is not what a render fails for.
  void write(const std::string& text) { std::ignore = std::fputs(text.c_str(), out_); }

  std::FILE* out_;
  Style style_;
  double last_line_s_ = 0;
  bool bar_shown_ = false;
};

}  // namespace meristem
