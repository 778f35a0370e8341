#include "renderer/report/page.h"

#include "renderer/language/json_value.h"
#include "renderer/language/json_writer.h"
#include "renderer/report/temporary_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>

namespace meristem {

namespace {

// RFC 4648, section 4.
std::string base64(const std::string& bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t block = 0;
    for (std::size_t k = 0; k < 3; ++k) block = block << 8 | (i + k < bytes.size() ? std::uint8_t(bytes[i + k]) : 0u);
    for (int k = 0; k < 4; ++k) text += digits[block >> (18 - 6 * k) & 63];
  }
  const std::size_t padding = (3 - bytes.size() % 3) % 3;
  return text.replace(text.size() - padding, padding, padding, '=');
}

std::string png_of(const Image& image) {
  const TemporaryFolder folder;
  const std::string path = folder.file("image.png");
  write_image(path, image);
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Nine colours of the map at equal distances; the page draws its scales with the same.
constexpr std::array<std::array<int, 3>, 9> magma{{{0, 0, 4},
                                                   {28, 16, 68},
                                                   {79, 18, 123},
                                                   {129, 37, 129},
                                                   {181, 54, 122},
                                                   {229, 80, 100},
                                                   {251, 135, 97},
                                                   {254, 194, 135},
                                                   {252, 253, 191}}};

}  // namespace

std::string report_page(const Value& data) {
  std::string page(report_page_head);
  // Inside <script> only "</script" and "<!--" could end or change the text
  for (const char c : to_json(data))
    if (c == '<')
      page += "\\u003c";
    else
      page += c;
  return page.append(report_page_tail);
}

Value report_image_value(const ReportImage& image) {
  return json::object({{"title", json::text(image.title)},
                       {"note", json::text(image.note)},
                       {"low", image.low.empty() ? Value{} : json::text(image.low)},
                       {"high", image.high.empty() ? Value{} : json::text(image.high)},
                       {"src", json::text("data:image/png;base64," + base64(png_of(image.image)))}});
}

Image heat_map(const Image& values, float white) {
  Image result{values.width, values.height, 3, {}};
  for (std::size_t i = 0; i < values.pixels.size(); i += std::size_t(values.channels)) {
    const float share = white > 0 && values.pixels[i] > 0 ? std::min(1.f, values.pixels[i] / white) : 0.f;
    const float at = share * float(magma.size() - 1);
    const std::size_t below = std::min(std::size_t(at), magma.size() - 2);
    for (std::size_t c = 0; c < 3; ++c)
      result.pixels.push_back(std::lerp(float(magma[below][c]), float(magma[below + 1][c]), at - float(below)) / 255);
  }
  return result;
}

float quantile(const Image& values, double share) {
  std::vector<float> sorted;
  for (std::size_t i = 0; i < values.pixels.size(); i += std::size_t(values.channels))
    if (std::isfinite(values.pixels[i])) sorted.push_back(values.pixels[i]);
  if (sorted.empty()) return 0;
  const auto at = sorted.begin() + std::ptrdiff_t(share * double(sorted.size() - 1));
  std::ranges::nth_element(sorted, at);
  return *at;
}

}  // namespace meristem
