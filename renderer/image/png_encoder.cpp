#include "renderer/image/png_encoder.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <string_view>

namespace meristem {

namespace {

using namespace std::string_view_literals;

void put(std::string& bytes, std::uint32_t value, int count = 4) {
  while (count-- > 0) bytes += char(value >> (8 * count) & 255);
}

void put_chunk(std::string& file, std::string_view type, std::string_view content) {
  put(file, std::uint32_t(content.size()));
  const std::size_t start = file.size();
  file.append(type).append(content);
  put(file, std::uint32_t(::crc32(0, reinterpret_cast<const Bytef*>(&file[start]), uInt(file.size() - start))));
}

// The colour space sRGB, also in the words of programs that know none by name: gamma, white and primaries.
void put_color_space(std::string& file) {
  std::string gamma, points;
  put(gamma, 45455);
  for (const std::uint32_t x : {31270, 32900, 64000, 33000, 30000, 60000, 15000, 6000}) put(points, x);
  put_chunk(file, "gAMA", gamma);
  put_chunk(file, "cHRM", points);
  put_chunk(file, "sRGB", "\0"sv);
}

// "2026:11:29 19:57:29", in UTC.
void put_time(std::string& file, const std::string& text) {
  std::array<unsigned, 6> t{};
  if (std::sscanf(text.c_str(), "%u:%u:%u %u:%u:%u", &t[0], &t[1], &t[2], &t[3], &t[4], &t[5]) != 6) return;
  std::string content;
  put(content, t[0], 2);
  for (std::size_t i = 1; i < t.size(); ++i) put(content, t[i], 1);
  put_chunk(file, "tIME", content);
}

void put_text(std::string& file, const std::string& name, const std::string& value) {
  constexpr std::size_t longest_name = 79;
  std::string content = name.substr(0, longest_name) + '\0';
  const bool is_ascii = std::ranges::all_of(value, [](char c) { return std::uint8_t(c) < 128; });
  if (!is_ascii) content.append("\0\0\0\0"sv);  // UTF-8: not compressed, no language, no other name
  put_chunk(file, is_ascii ? "tEXt" : "iTXt", content + value);
}

// Compressed rows as chunks of the file.
class DataWriter {
 public:
  explicit DataWriter(std::string& file) : file_(file) {
    constexpr int level = 6;  // without Z_FILTERED, which makes noisy pictures an eighth larger
    if (::deflateInit(&stream_, level) != Z_OK) throw std::bad_alloc();
    begin_chunk();
  }
  ~DataWriter() { ::deflateEnd(&stream_); }
  DataWriter(const DataWriter&) = delete;
  DataWriter& operator=(const DataWriter&) = delete;

  void add(std::string_view row) { run(row, Z_NO_FLUSH); }
  void finish() {
    run({}, Z_FINISH);
    end_chunk();
  }

 private:
  void run(std::string_view bytes, int flush) {
    stream_.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(bytes.data()));  // zlib only reads it
    stream_.avail_in = uInt(bytes.size());
    int result = Z_OK;
    do {
      if (stream_.avail_out == 0) {
        end_chunk();
        begin_chunk();
      }
      result = ::deflate(&stream_, flush);
    } while (stream_.avail_in > 0 || (flush == Z_FINISH && result != Z_STREAM_END));
  }
  void begin_chunk() {
    stream_.next_out = reinterpret_cast<Bytef*>(chunk_.data());
    stream_.avail_out = uInt(chunk_.size());
  }
  void end_chunk() {
    const std::size_t size = chunk_.size() - stream_.avail_out;
    if (size > 0) put_chunk(file_, "IDAT", {chunk_.data(), size});
  }

  std::string& file_;
  z_stream stream_{};
  std::string chunk_ = std::string(std::size_t(1) << 16, '\0');
};

int paeth(int left, int up, int corner) {
  const int p = left + up - corner, a = std::abs(p - left), b = std::abs(p - up), c = std::abs(p - corner);
  return a <= b && a <= c ? left : b <= c ? up : corner;
}

// Chooses for each row the filter whose differences are the least, as the standard advises (12.8).
class RowFilter {
 public:
  RowFilter(std::size_t row_bytes, std::size_t pixel_bytes)
      : pixel_(pixel_bytes), above_(row_bytes, 0), best_(row_bytes + 1, '\0'), tried_(row_bytes + 1, '\0') {}

  std::string_view filter(const std::vector<std::uint8_t>& row) {
    std::uint64_t least = ~std::uint64_t(0);
    for (int type = 0; type < 5; ++type) {
      apply(type, row);
      std::uint64_t sum = 0;
      for (std::size_t i = 1; i < tried_.size(); ++i) sum += std::uint64_t(std::abs(int(std::int8_t(tried_[i]))));
      if (sum >= least) continue;
      least = sum;
      std::swap(best_, tried_);
    }
    above_ = row;
    return best_;
  }

 private:
  void apply(int type, const std::vector<std::uint8_t>& row) {
    const auto with = [&](auto predict) {
      tried_[0] = char(type);
      for (std::size_t i = 0; i < row.size(); ++i) {
        const bool is_first = i < pixel_;
        const int left = is_first ? 0 : row[i - pixel_], corner = is_first ? 0 : above_[i - pixel_];
        tried_[i + 1] = char(row[i] - predict(left, int(above_[i]), corner));
      }
    };
    switch (type) {
      case 0: return with([](int, int, int) { return 0; });
      case 1: return with([](int left, int, int) { return left; });
      case 2: return with([](int, int up, int) { return up; });
      case 3: return with([](int left, int up, int) { return (left + up) / 2; });
      default: return with(paeth);
    }
  }

  const std::size_t pixel_;
  std::vector<std::uint8_t> above_;
  std::string best_, tried_;
};

std::uint32_t step_of(float value, std::uint32_t last) {
  return value > 0 ? std::uint32_t(std::min(value, 1.0f) * float(last) + 0.5f) : 0;
}

void put_pixels(std::string& file, const Image& image, int channels, int bits) {
  const std::size_t value_bytes = std::size_t(bits) / 8, pixel_bytes = value_bytes * std::size_t(channels);
  const std::uint32_t last = (1u << bits) - 1;
  std::vector<std::uint8_t> row(pixel_bytes * std::size_t(image.width));
  RowFilter filter(row.size(), pixel_bytes);
  DataWriter data(file);
  const float* pixel = image.pixels.data();
  for (int y = 0; y < image.height; ++y) {
    auto out = row.begin();
    for (int x = 0; x < image.width; ++x, pixel += image.channels)
      for (int c = 0; c < channels; ++c) {
        const std::uint32_t step = step_of(pixel[c], last);
        if (value_bytes == 2) *out++ = std::uint8_t(step >> 8);
        *out++ = std::uint8_t(step & 255);
      }
    data.add(filter.filter(row));
  }
  data.finish();
}

}  // namespace

std::string encode_png(const Image& image, const Metadata& metadata, int bits) {
  const int channels = std::min(image.channels, 3);
  std::string file("\x89PNG\r\n\x1a\n"), header;
  put(header, std::uint32_t(image.width));
  put(header, std::uint32_t(image.height));
  put(header, std::uint32_t(bits), 1);
  put(header, channels == 3 ? 2 : 0, 1);  // RGB or grey
  put(header, 0, 3);                      // the one way to compress, the one to filter; rows from top to bottom
  put_chunk(file, "IHDR", header);
  put_color_space(file);
  for (const auto& [name, value] : metadata)
    if (name == "DateTime")
      put_time(file, value);
    else
      put_text(file, name, value);
  put_pixels(file, image, channels, bits);
  put_chunk(file, "IEND", "");
  return file;
}

}  // namespace meristem
