#include "renderer/image/exr_parts.h"

#include "geometry/base/check.h"
#include "geometry/base/parallel.h"
#include "renderer/image/half_bits.h"

#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <new>
#include <numeric>
#include <string_view>

namespace meristem {

namespace {

constexpr float max_half = 65504.0f;
constexpr int block_rows = 16;    // that are compressed together
constexpr int deflate_level = 4;  // OpenEXR's own: 6 takes twice the time for a percent
constexpr std::size_t short_name = 31;

static_assert(std::endian::native == std::endian::little, "EXR files hold numbers as they lie in memory");

void check_part(const ExrPart& part, const Image& first) {
  const Image& image = part.image;
  CHECK(image.width == first.width && image.height == first.height, "part {} has another size", part.name);
  CHECK(part.channels.size() == std::size_t(image.channels), "part {} has {} channels and {} names", part.name,
        image.channels, part.channels.size());
  CHECK(image.pixels.size() == std::size_t(image.width) * std::size_t(image.height) * part.channels.size(),
        "part {} has {} values", part.name, image.pixels.size());
}

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}
void put_name(std::string& bytes, std::string_view name) { bytes.append(name).push_back('\0'); }

// Channels stand in the order of their names.
std::vector<std::size_t> file_order(const std::vector<std::string>& channels) {
  std::vector<std::size_t> order(channels.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::ranges::sort(order, {}, [&](std::size_t i) -> const std::string& { return channels[i]; });
  return order;
}

// The attributes of one part.
class Header {
 public:
  Header(const ExrPart& part, const ExrFrame& frame, const Metadata& metadata, bool is_one_of_several) {
    const Image& image = part.image;
    add("channels", "chlist", channel_list(part));
    add("compression", "compression", std::string(1, '\3'));  // "zip": blocks of 16 rows
    add("dataWindow", "box2i", values(frame.x, frame.y, frame.x + image.width - 1, frame.y + image.height - 1));
    add("displayWindow", "box2i", values(0, 0, frame.full_width - 1, frame.full_height - 1));
    add("lineOrder", "lineOrder", std::string(1, '\0'));
    add("pixelAspectRatio", "float", values(1.0f));
    add("screenWindowCenter", "v2f", values(0.0f, 0.0f));
    add("screenWindowWidth", "float", values(1.0f));
    // Rec.709 primaries and the white D65 (ITU-R BT.709-6, item 1.3)
    if (part.color)
      add("chromaticities", "chromaticities", values(0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f));
    if (!part.name.empty()) add("name", "string", part.name);
    if (is_one_of_several) {
      add("type", "string", "scanlineimage");
      add("chunkCount", "int", values((image.height + block_rows - 1) / block_rows));
    }
    for (const Metadata& list : {metadata, part.metadata})
      for (const auto& [name, value] : list) add(name == "DateTime" ? "capDate" : name, "string", value);
    bytes_ += '\0';
  }

  const std::string& bytes() const { return bytes_; }
  bool has_long_names() const { return has_long_names_; }

 private:
  template <class... T>
  static std::string values(T... value) {
    std::string bytes;
    (put(bytes, value), ...);
    return bytes;
  }

  std::string channel_list(const ExrPart& part) {
    std::string bytes;
    for (const std::size_t c : file_order(part.channels)) {
      note_name(part.channels[c]);
      put_name(bytes, part.channels[c]);
      put(bytes, std::int32_t(part.half ? 1 : 2));
      put(bytes, std::int32_t(0));  // perceived as it is linear
      put(bytes, std::int32_t(1));  // every column and
      put(bytes, std::int32_t(1));  // every row
    }
    return bytes += '\0';
  }
  void add(const std::string& name, std::string_view type, std::string_view value) {
    note_name(name);
    put_name(bytes_, name);
    put_name(bytes_, type);
    put(bytes_, std::int32_t(value.size()));
    bytes_.append(value);
  }
  void note_name(const std::string& name) { has_long_names_ = has_long_names_ || name.size() > short_name; }

  std::string bytes_;
  bool has_long_names_ = false;
};

// The rows of a block as the file has them: row by row, channel by channel. Counts what was clamped.
std::string block_values(const ExrPart& part, int first_row, int last_row, std::size_t& outside) {
  const Image& image = part.image;
  const auto width = std::size_t(image.width), channels = std::size_t(image.channels);
  std::string bytes(width * channels * std::size_t(last_row - first_row) * (part.half ? 2 : 4), '\0');
  char* out = bytes.data();
  const std::vector<std::size_t> order = file_order(part.channels);
  for (int y = first_row; y < last_row; ++y)
    for (const std::size_t c : order) {
      const float* value = &image.pixels[std::size_t(y) * width * channels + c];
      for (std::size_t x = 0; x < width; ++x, value += channels)
        if (part.half) {
          const float clamped = std::isnan(*value) ? *value : std::clamp(*value, -max_half, max_half);
          outside += clamped < *value || clamped > *value;
          const std::uint16_t half = half_bits(clamped);
          std::memcpy(out, &half, sizeof(half));
          out += sizeof(half);
        } else {
          std::memcpy(out, value, sizeof(*value));
          out += sizeof(*value);
        }
    }
  return bytes;
}

// First the even bytes, then the odd ones; of each its difference from the one before.
std::string prepared(const std::string& bytes) {
  std::string result(bytes.size(), '\0');
  const std::size_t half = (bytes.size() + 1) / 2;
  for (std::size_t i = 0; i < bytes.size(); ++i) result[i / 2 + (i % 2 ? half : 0)] = bytes[i];
  std::uint8_t before = 0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const auto here = std::uint8_t(result[i]);
    if (i > 0) result[i] = char(here - before + 128);
    before = here;
  }
  return result;
}

// As they are if that is no longer.
std::string compressed(std::string bytes) {
  const std::string source = prepared(bytes);
  uLongf size = ::compressBound(uLong(source.size()));
  std::string result(size, '\0');
  if (::compress2(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(source.data()),
                  uLong(source.size()), deflate_level) != Z_OK)
    throw std::bad_alloc();
  if (size >= bytes.size()) return bytes;
  result.resize(size);
  return result;
}

std::string headers_of(const std::vector<ExrPart>& parts, const ExrFrame& frame, const Metadata& metadata) {
  const bool are_several = parts.size() > 1;
  std::string headers;
  bool has_long_names = false;
  for (const ExrPart& part : parts) {
    const Header header(part, frame, &part == &parts[0] ? metadata : Metadata{}, are_several);
    headers += header.bytes();
    has_long_names = has_long_names || header.has_long_names();
  }
  if (are_several) headers += '\0';
  constexpr std::uint32_t magic = 20000630, version = 2, long_names = 0x400, several_parts = 0x1000;
  std::string result;
  put(result, magic);
  put(result, version | (has_long_names ? long_names : 0) | (are_several ? several_parts : 0));
  return result + headers;
}

}  // namespace

std::size_t write_exr_parts(const std::string& path, const std::vector<ExrPart>& parts, const ExrFrame& frame,
                            const Metadata& metadata) {
  CHECK(!parts.empty(), "an EXR file without parts");
  for (const ExrPart& part : parts) check_part(part, parts[0].image);
  const int height = parts[0].image.height;
  const std::size_t blocks = std::size_t((height + block_rows - 1) / block_rows);
  std::vector<std::string> chunks(parts.size() * blocks);
  std::atomic<std::size_t> outside{0};
  parallel_for(chunks.size(), [&](std::size_t i) {
    const int first_row = int(i % blocks) * block_rows;
    std::size_t outside_here = 0;
    const std::string bytes =
        compressed(block_values(parts[i / blocks], first_row, std::min(first_row + block_rows, height), outside_here));
    std::string& chunk = chunks[i];
    if (parts.size() > 1) put(chunk, std::int32_t(i / blocks));
    put(chunk, std::int32_t(frame.y + first_row));
    put(chunk, std::int32_t(bytes.size()));
    chunk += bytes;
    outside += outside_here;
  });

  std::string head = headers_of(parts, frame, metadata);
  std::uint64_t offset = head.size() + chunks.size() * sizeof(offset);
  for (const std::string& chunk : chunks) {
    put(head, offset);
    offset += chunk.size();
  }
  AtomicFile file(path);
  file.append(head);
  for (const std::string& chunk : chunks) file.append(chunk);
  file.commit();
  return outside;
}

}  // namespace meristem
