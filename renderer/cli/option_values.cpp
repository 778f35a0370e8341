#include "renderer/cli/option_values.h"

#include "renderer/cli/exit_code.h"
#include "renderer/loading/load_settings.h"

#include <fmt/format.h>

#include <charconv>
#include <sstream>
#include <string_view>
#include <vector>

namespace meristem {

namespace {

constexpr int max_samples = 1 << 20;
constexpr int max_frames = 100'000;

// The whole numbers between separators; empty if the text is not made like that.
std::vector<int> parse_integers(std::string_view text, char separator) {
  std::vector<int> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  for (;;) {
    int n = 0;
    const auto [after, error] = std::from_chars(at, end, n);
    if (error != std::errc()) return {};
    numbers.push_back(n);
    if (after == end) return numbers;
    if (*after != separator) return {};
    at = after + 1;
  }
}

}  // namespace

std::pair<int, int> parse_size(const std::string& text) {
  const std::vector<int> n = parse_integers(text, 'x');
  if (n.size() != 2 || n[0] < 1 || n[1] < 1 || n[0] > max_image_side || n[1] > max_image_side)
    throw UsageError(fmt::format("\"{}\" is no size: expected WIDTHxHEIGHT, each from 1 to {}", text, max_image_side));
  return {n[0], n[1]};
}

std::uint64_t parse_memory(const std::string& text) {
  if (const auto bytes = parse_bytes(text)) return *bytes;
  throw UsageError(fmt::format("\"{}\" is no amount of memory: expected one like 512M or 1.5G", text));
}

std::vector<BudgetChoice> parse_budgets(const std::string& text) {
  std::vector<BudgetChoice> budgets;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    if (!part.ends_with('%')) {
      budgets.push_back({.bytes = parse_memory(part)});
      continue;
    }
    double percent = 0;
    const char* const end = part.data() + part.size() - 1;
    const auto [after, error] = std::from_chars(part.data(), end, percent);
    if (error != std::errc() || after != end || !(percent > 0) || percent > 100)
      throw UsageError(fmt::format("\"{}\" is no share: expected one above 0% up to 100%", part));
    budgets.push_back({.share = percent / 100});
  }
  return budgets;
}

PixelWindow parse_crop(const std::string& text) {
  const std::vector<int> n = parse_integers(text, ',');
  const PixelWindow window = n.size() == 4 ? PixelWindow{n[0], n[1], n[2], n[3]} : PixelWindow{};
  if (window.empty() || window.x0 < 0 || window.y0 < 0)
    throw UsageError(
        fmt::format("\"{}\" is no part of the image: expected x0,y0,x1,y1 in pixels, x0 < x1 and y0 < y1", text));
  return window;
}

std::pair<int, int> parse_pixel(const std::string& text) {
  const std::vector<int> n = parse_integers(text, ',');
  if (n.size() != 2 || n[0] < 0 || n[1] < 0)
    throw UsageError(fmt::format("\"{}\" is no pixel: expected x,y, such as 640,360", text));
  return {n[0], n[1]};
}

double parse_duration(const std::string& text) {
  double seconds = 0;
  const char* at = text.data();
  const char* const end = at + text.size();
  bool right = at != end;
  while (right && at != end) {
    double number = 0;
    const auto [after, error] = std::from_chars(at, end, number);
    constexpr std::string_view units = "smh";
    const std::size_t unit = after == end ? 0 : units.find(*after);
    right = error == std::errc() && number >= 0 && unit != units.npos;
    seconds += number * (unit == 0 ? 1 : unit == 1 ? 60 : 3600);
    at = after == end ? end : after + 1;
  }
  if (!right || !(seconds > 0 && seconds < 1e9))
    throw UsageError(fmt::format("\"{}\" is no duration: expected one like 90s, 5m or 1h30m", text));
  return seconds;
}

SampleRange parse_sample_range(const std::string& text) {
  const std::vector<int> n = parse_integers(text, ':');
  if (n.size() != 2 || n[0] < 0 || n[0] >= n[1] || n[1] > max_samples)
    throw UsageError(
        fmt::format("\"{}\" is no range of samples: expected FIRST:END, for example 0:64 and then 64:128, "
                    "END at most {}",
                    text, max_samples));
  return {std::uint32_t(n[0]), std::uint32_t(n[1])};
}

std::vector<int> parse_frames(const std::string& text) {
  const std::size_t by = text.find('x');
  const std::vector<int> ends = parse_integers(std::string_view(text).substr(0, by), '-');
  const std::vector<int> step =
      by == std::string::npos ? std::vector{1} : parse_integers(std::string_view(text).substr(by + 1), 'x');
  const bool right = (ends.size() == 1 || (ends.size() == 2 && ends[1] >= ends[0])) && ends[0] >= 0 &&
                     step.size() == 1 && step[0] >= 1 && (ends.back() - ends[0]) / step[0] < max_frames;
  if (!right) throw UsageError(fmt::format("\"{}\" is no range of frames: expected one like 7, 1-48 or 1-48x2", text));
  std::vector<int> frames;
  for (long frame = ends[0]; frame <= ends.back(); frame += step[0]) frames.push_back(int(frame));
  return frames;
}

}  // namespace meristem
