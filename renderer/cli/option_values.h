// The values of command line options that are more than a number. Each throws UsageError with what it expected.
#pragma once

#include "renderer/film/film.h"

#include <cstdint>
#include <string>
#include <utility>

namespace meristem {

constexpr int max_image_side = 65536;

// "640x360": width and height, each from 1 to max_image_side.
std::pair<int, int> parse_size(const std::string& text);

// "512M", "1.5G", "2GiB", "1000000": bytes; K, M, G, T are powers of 1024. At least 1.
std::uint64_t parse_memory(const std::string& text);

// "x0,y0,x1,y1" in pixels from the top left corner, x1 and y1 excluded; not empty.
PixelWindow parse_crop(const std::string& text);

}  // namespace meristem
