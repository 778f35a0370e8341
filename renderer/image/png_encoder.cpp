#include "renderer/image/png_encoder.h"

#include "renderer/image/quantizer.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdio>
#include <exception>

namespace meristem {

namespace {

// All that the file holds, and room for a row of it.
struct Content {
  const Image& image;
  const int channels, bits;
  const Quantizer quantizer;
  Metadata metadata;
  std::vector<png_text> texts;  // point into `metadata`
  png_time time{};
  bool has_time = false;
  std::vector<png_byte> row;
};

// Where the library's callbacks put what they are given.
struct Output {
  std::string bytes;
  std::array<char, 100> reason{};  // of the error that ended it
};

// "2026:11:29 19:57:29", in UTC.
bool read_time(const std::string& text, png_time& time) {
  std::array<unsigned, 6> t{};
  if (std::sscanf(text.c_str(), "%u:%u:%u %u:%u:%u", &t[0], &t[1], &t[2], &t[3], &t[4], &t[5]) != 6) return false;
  time = {png_uint_16(t[0]), png_byte(t[1]), png_byte(t[2]), png_byte(t[3]), png_byte(t[4]), png_byte(t[5])};
  return true;
}

png_text text_of(std::string& name, std::string& value) {
  const bool is_ascii = std::ranges::all_of(value, [](char c) { return std::uint8_t(c) < 128; });
  png_text text{};
  text.compression = is_ascii ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;  // the latter is in UTF-8
  text.key = name.data();
  text.text = value.data();
  return text;
}

void fill_row(Content& content, int y) {
  const Image& image = content.image;
  const float* pixel = &image.pixels[std::size_t(y) * std::size_t(image.width) * std::size_t(image.channels)];
  png_byte* out = content.row.data();
  for (int x = 0; x < image.width; ++x, pixel += image.channels)
    for (int c = 0; c < content.channels; ++c) {
      const std::uint32_t step = content.quantizer.step(pixel[c], x, y, c);
      if (content.bits == 16) *out++ = png_byte(step >> 8);
      *out++ = png_byte(step & 255);
    }
}

void append(png_structp png, png_bytep bytes, std::size_t size) {
  bool has_room = true;
  try {
    static_cast<Output*>(png_get_io_ptr(png))->bytes.append(reinterpret_cast<const char*>(bytes), size);
  } catch (const std::exception&) {
    has_room = false;  // an exception must not pass through the library, nor a jump leave this block
  }
  if (!has_room) png_error(png, "out of memory");
}
void flush(png_structp) {}
void ignore_warning(png_structp, png_const_charp) {}

[[noreturn]] void stop(png_structp png, png_const_charp reason) {
  Output& output = *static_cast<Output*>(png_get_error_ptr(png));
  std::snprintf(output.reason.data(), output.reason.size(), "%s", reason);
  png_longjmp(png, 1);
}

void write_header(png_structp png, png_infop info, Content& content) {
  png_set_IHDR(png, info, png_uint_32(content.image.width), png_uint_32(content.image.height), content.bits,
               content.channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  // Also in the words of programs that know no colour space by name: gamma, white and primaries.
  png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  if (content.has_time) png_set_tIME(png, info, &content.time);
  png_set_text(png, info, content.texts.data(), int(content.texts.size()));
  constexpr int level = 6;
  constexpr int strategy =
      0;  // zlib's default; the library's, for filtered rows, makes noisy pictures an eighth larger
  png_set_compression_level(png, level);
  png_set_compression_strategy(png, strategy);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_ALL_FILTERS);
  png_write_info(png, info);
}

// Whether it went well. The library leaves by a jump that ends here: nothing below this may need a destructor.
bool write(png_structp png, png_infop info, Content& content) {
  if (setjmp(png_jmpbuf(png))) return false;
  write_header(png, info, content);
  for (int y = 0; y < content.image.height; ++y) {
    fill_row(content, y);
    png_write_row(png, content.row.data());
  }
  png_write_end(png, nullptr);
  return true;
}

// The library's objects.
class Writer {
 public:
  explicit Writer(Output& output)
      : png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, &output, stop, ignore_warning)),
        info_(png_ ? png_create_info_struct(png_) : nullptr) {
    if (png_) png_set_write_fn(png_, &output, append, flush);
  }
  ~Writer() { png_destroy_write_struct(&png_, &info_); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  bool run(Content& content) { return info_ && write(png_, info_, content); }

 private:
  png_structp png_;
  png_infop info_;
};

}  // namespace

std::string encode_png(const std::string& path, const Image& image, const Metadata& metadata,
                       const WriteOptions& options) {
  const int channels = std::min(image.channels, 3);
  Content content{image, channels, options.bits, {options.bits, options}, metadata, {}, {}, false, {}};
  for (auto& [name, value] : content.metadata)
    if (name == "DateTime")
      content.has_time = read_time(value, content.time);
    else
      content.texts.push_back(text_of(name, value));
  content.row.resize(std::size_t(image.width) * std::size_t(channels) * std::size_t(options.bits / 8));
  Output output;
  if (!Writer(output).run(content)) {
    const char* const reason = output.reason[0] ? output.reason.data() : "out of memory";
    throw FileError(fmt::format("cannot write {}: {}", path, reason));
  }
  return std::move(output.bytes);
}

}  // namespace meristem
