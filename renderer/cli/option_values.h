// The values of command line options that are more than a number. Each throws UsageError with what it expected.
#pragma once

#include "renderer/film/film_file.h"
#include "renderer/report/comparison.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace meristem {

constexpr int max_image_side = 65536;

// "640x360": width and height, each from 1 to max_image_side.
std::pair<int, int> parse_size(const std::string& text);

// "512M", "1.5G", "2GiB", "1000000": bytes; K, M, G, T are powers of 1024. At least 1.
std::uint64_t parse_memory(const std::string& text);

// "x0,y0,x1,y1" in pixels from the top left corner, x1 and y1 excluded; not empty.
PixelWindow parse_crop(const std::string& text);

// "640,360": x and y of a pixel, from 0.
std::pair<int, int> parse_pixel(const std::string& text);

// "25%,10%,64M": budgets of the geometry cache, as shares above 0 up to 100 % or as amounts of memory.
std::vector<BudgetChoice> parse_budgets(const std::string& text);

// "90", "90s", "5m", "1.5h", "1h30m": seconds, more than 0.
double parse_duration(const std::string& text);

// "0:64": the first, and the one after the last; not empty.
SampleRange parse_sample_range(const std::string& text);

// "1-48", "1-48x2" (every second), "7"; at most 100,000 frames, none negative.
std::vector<int> parse_frames(const std::string& text);

}  // namespace meristem
