#include "renderer/session/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <sys/ioctl.h>
#include <unistd.h>

namespace meristem {

namespace {

constexpr double line_interval_s = 5;
constexpr double json_interval_s = 0.5;

int terminal_columns(std::FILE* out) {
  winsize size{};
  return ::ioctl(::fileno(out), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string percent(const RenderProgress& p) { return fmt::format("{:3.0f} %", std::floor(p.fraction() * 100)); }

std::string times(const RenderProgress& p) {
  std::string text = fmt::format("pass {}/{}, {}", p.pass, p.passes, format_duration(p.elapsed_s));
  if (const auto left = p.seconds_left()) text += fmt::format(", {} left", format_duration(*left));
  return text;
}

}  // namespace

std::string format_duration(double seconds) {
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  const long s = std::lround(seconds);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {} s", s / 60, s % 60);
  return fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
}

std::string format_bar(const RenderProgress& progress, int columns) {
  const std::string left = percent(progress) + " [", right = "] " + times(progress);
  const int room = std::max(0, columns - int(left.size() + right.size()));
  const int full = int(progress.fraction() * room);
  return left + std::string(std::size_t(full), '=') + std::string(std::size_t(room - full), ' ') + right;
}

std::string format_line(const RenderProgress& progress) {
  return fmt::format("{:.0f} %, {}", std::floor(progress.fraction() * 100), times(progress));
}

ProgressDisplay::Style ProgressDisplay::style_for(std::FILE* out) {
  return ::isatty(::fileno(out)) ? Style::Bar : Style::Lines;
}

std::string format_json(const RenderProgress& p) {
  const auto left = p.seconds_left();
  return fmt::format(
      R"({{"event": "progress", "fraction": {:.4f}, "samples": {}, "samples_total": {}, "pass": {}, "passes": {}, )"
      R"("elapsed_s": {:.3f}, "left_s": {}}})",
      p.fraction(), p.samples_done, p.samples_total, p.pass, p.passes, p.elapsed_s,
      left ? fmt::format("{:.3f}", *left) : "null");
}

void ProgressDisplay::clear() {
  if (bar_shown_) write("\r\033[K");
  std::fflush(out_);
  bar_shown_ = false;
}

void ProgressDisplay::update(const RenderProgress& progress) {
  if (style_ == Style::None) return;
  if (style_ == Style::Bar) {
    write("\r\033[K" + format_bar(progress, terminal_columns(out_) - 1));
    bar_shown_ = true;
  } else if (style_ == Style::Json) {
    if (progress.elapsed_s - last_line_s_ >= json_interval_s || progress.samples_done >= progress.samples_total) {
      last_line_s_ = progress.elapsed_s;
      write(format_json(progress) + "\n");
    }
  } else if (progress.elapsed_s - last_line_s_ >= line_interval_s) {
    last_line_s_ = progress.elapsed_s;
    write(format_line(progress) + "\n");
  }
  std::fflush(out_);
}

}  // namespace meristem
