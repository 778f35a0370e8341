#include "renderer/cli/option_values.h"

#include "renderer/cli/exit_code.h"
#include "renderer/loading/load_settings.h"

#include <fmt/format.h>

#include <charconv>
#include <string_view>
#include <vector>

namespace meristem {

namespace {

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

PixelWindow parse_crop(const std::string& text) {
  const std::vector<int> n = parse_integers(text, ',');
  const PixelWindow window = n.size() == 4 ? PixelWindow{n[0], n[1], n[2], n[3]} : PixelWindow{};
  if (window.empty() || window.x0 < 0 || window.y0 < 0)
    throw UsageError(
        fmt::format("\"{}\" is no part of the image: expected x0,y0,x1,y1 in pixels, x0 < x1 and y0 < y1", text));
  return window;
}

}  // namespace meristem
