#include "renderer/session/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <sys/ioctl.h>
#include <unistd.h>

namespace meristem {

namespace {

constexpr double line_interval_s = 5;
constexpr double estimate_from = 0.01;  // of the work: earlier the time left is a guess

int terminal_columns(std::FILE* out) {
  winsize size{};
  return ::ioctl(::fileno(out), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string percent(const RenderProgress& p) { return fmt::format("{:3.0f} %", std::floor(p.fraction() * 100)); }

std::string times(const RenderProgress& p) {
  std::string text = fmt::format("pass {}/{}, {}", p.pass, p.passes, format_duration(p.elapsed_s));
  if (p.fraction() >= estimate_from && p.fraction() < 1)
    text += fmt::format(", {} left", format_duration(p.elapsed_s * (1 / p.fraction() - 1)));
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

ProgressDisplay::~ProgressDisplay() {
  if (bar_shown_) fmt::print(out_, "\r\033[K");
}

void ProgressDisplay::update(const RenderProgress& progress) {
  if (style_ == Style::None) return;
  if (style_ == Style::Bar) {
    fmt::print(out_, "\r\033[K{}", format_bar(progress, terminal_columns(out_) - 1));
    bar_shown_ = true;
  } else if (progress.elapsed_s - last_line_s_ >= line_interval_s) {
    last_line_s_ = progress.elapsed_s;
    fmt::print(out_, "{}\n", format_line(progress));
  }
  std::fflush(out_);
}

}  // namespace meristem
