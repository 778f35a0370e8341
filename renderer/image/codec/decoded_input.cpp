#include "renderer/image/codec/decoded_input.h"

#include <Imath/half.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>
#include <vector>

namespace meristem {

namespace {

// IEC 61966-2-1, section 5.2.
float decoded(float x) { return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f); }

// Of bytes, which are most files: halves tell their 256 values apart.
half decoded_byte(float x) {
  static const std::array<half, 256> table = [] {
    std::array<half, 256> t;
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = half(decoded(float(i) / 255));
    return t;
  }();
  return table[std::size_t(x * 255 + 0.5f)];
}

}  // namespace

bool DecodedInput::open(const std::string& name, OIIO::ImageSpec& spec) {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);  // else colours come multiplied by alpha, in display encoding
  file_ = OIIO::ImageInput::open(name.substr(std::string_view(prefix).size()), &config);
  if (!file_) {
    errorfmt("{}", OIIO::geterror());
    return false;
  }
  const OIIO::ImageSpec& of_file = file_->spec();
  const bool is_bytes = of_file.format == OIIO::TypeDesc::UINT8;
  m_spec = OIIO::ImageSpec(of_file.width, of_file.height, std::min(of_file.nchannels, 3),
                           is_bytes ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
  m_spec.x = of_file.x, m_spec.y = of_file.y;
  m_spec.full_x = of_file.full_x, m_spec.full_y = of_file.full_y;
  m_spec.full_width = of_file.full_width, m_spec.full_height = of_file.full_height;
  spec = m_spec;
  return true;
}

bool DecodedInput::close() {
  file_.reset();
  return true;
}

// Of a tiled file, the rows of tiles around them.
bool DecodedInput::read_rows(int begin, int end, float* rows) {
  const OIIO::ImageSpec& of_file = file_->spec();
  const int channels = m_spec.nchannels;
  if (of_file.tile_width == 0)
    return file_->read_scanlines(0, 0, begin, end, 0, 0, channels, OIIO::TypeDesc::FLOAT, rows);
  const int side = of_file.tile_height, top = m_spec.y;
  const int first = top + (begin - top) / side * side;
  const int last = std::min(top + (end - top + side - 1) / side * side, top + m_spec.height);
  const std::size_t row = std::size_t(m_spec.width) * std::size_t(channels);
  std::vector<float> tiles(row * std::size_t(last - first));
  if (!file_->read_tiles(0, 0, m_spec.x, m_spec.x + m_spec.width, first, last, 0, 1, 0, channels, OIIO::TypeDesc::FLOAT,
                         tiles.data()))
    return false;
  std::copy_n(tiles.begin() + std::ptrdiff_t(row * std::size_t(begin - first)), row * std::size_t(end - begin), rows);
  return true;
}

bool DecodedInput::read_native_scanlines(int, int, int begin, int end, int, void* data) {
  std::vector<float> values(std::size_t(m_spec.width) * std::size_t(m_spec.nchannels) * std::size_t(end - begin));
  if (!file_ || !read_rows(begin, end, values.data())) {
    errorfmt("{}", file_ ? file_->geterror() : "not open");
    return false;
  }
  if (m_spec.format == OIIO::TypeDesc::HALF)
    std::ranges::transform(values, static_cast<half*>(data), decoded_byte);
  else
    std::ranges::transform(values, static_cast<float*>(data), decoded);
  return true;
}

}  // namespace meristem
