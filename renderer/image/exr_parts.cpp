#include "renderer/image/exr_parts.h"

#include "geometry/base/check.h"
#include "geometry/base/parallel.h"

#include <OpenEXR/openexr.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <exception>
#include <memory>
#include <span>
#include <sstream>

namespace meristem {

namespace {

constexpr float max_half = 65504.0f;
constexpr int deflate_level = 4;  // 6 takes twice the time for a percent

// Clamps to the range of a half and returns how many that changes. NaN stays.
std::size_t clamp_to_half(std::span<float> values) {
  std::size_t outside = 0;
  for (float& value : values)
    if (std::abs(value) > max_half) {
      value = std::copysign(max_half, value);
      ++outside;
    }
  return outside;
}

std::int64_t append(exr_const_context_t, void* file, const void* data, std::uint64_t size, std::uint64_t offset,
                    exr_stream_error_func_ptr_t) {
  std::string& bytes = *static_cast<std::string*>(file);
  try {
    bytes.resize(std::max(bytes.size(), std::size_t(offset + size)));
  } catch (const std::exception&) {
    return -1;
  }
  std::memcpy(&bytes[offset], data, size);
  return std::int64_t(size);
}

// What compresses a block, with its memory.
struct Encoder {
  explicit Encoder(exr_const_context_t file) : context(file) {}
  ~Encoder() { exr_encoding_destroy(context, &pipeline); }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;

  exr_const_context_t context;
  exr_encode_pipeline_t pipeline{};
};

// A file that is made in memory: first all headers, then of each part all blocks.
class ExrFile {
 public:
  explicit ExrFile(const std::string& path) : path_(path) {
    exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
    options.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};  // else it prints them
    options.user_data = &bytes_;
    options.write_fn = append;
    options.zip_level = deflate_level;
    check(exr_start_write(&context_, path.c_str(), EXR_WRITE_FILE_DIRECTLY, &options));
  }
  ~ExrFile() { exr_finish(&context_); }
  ExrFile(const ExrFile&) = delete;
  ExrFile& operator=(const ExrFile&) = delete;

  void add_header(const ExrPart& part, const ExrFrame& frame);
  void add_metadata(int part_index, const Metadata& metadata);
  void end_headers(int part_count);
  // Returns how many values were clamped.
  std::size_t add_blocks(int part_index, const ExrPart& part, int first_row);

  const std::string& bytes() const { return bytes_; }

 private:
  void add_matrix(int part_index, const std::string& name, const std::string& numbers);
  void check(exr_result_t result) const {
    if (result != EXR_ERR_SUCCESS)
      throw FileError(fmt::format("cannot write {}: {}", path_, exr_get_default_error_message(result)));
  }
  std::string encoded(const exr_chunk_info_t& block, int part_index, const ExrPart& part, const float* values) const;

  const std::string& path_;
  std::string bytes_;
  exr_context_t context_ = nullptr;
};

void ExrFile::add_header(const ExrPart& part, const ExrFrame& frame) {
  int index = 0;
  check(exr_set_longname_support(context_, 1));
  check(exr_add_part(context_, part.name.c_str(), EXR_STORAGE_SCANLINE, &index));
  const exr_attr_box2i_t full{{0, 0}, {frame.full_width - 1, frame.full_height - 1}};
  const exr_attr_box2i_t data{{frame.x, frame.y}, {frame.x + part.rows.width - 1, frame.y + part.rows.height - 1}};
  const exr_attr_v2f_t center{0, 0};
  check(exr_initialize_required_attr(context_, index, &full, &data, 1, &center, 1, EXR_LINEORDER_INCREASING_Y,
                                     EXR_COMPRESSION_ZIP));
  for (const std::string& channel : part.channels)
    check(exr_add_channel(context_, index, channel.c_str(), part.half ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT,
                          EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
  // Rec.709 primaries and the white D65 (ITU-R BT.709-6, item 1.3)
  const exr_attr_chromaticities_t rec709{0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};
  if (part.color) check(exr_attr_set_chromaticities(context_, index, "chromaticities", &rec709));
  add_metadata(index, part.metadata);
}

void ExrFile::add_metadata(int part_index, const Metadata& metadata) {
  for (const auto& [name, value] : metadata)
    if (name == "worldToCamera" || name == "worldToNDC")
      add_matrix(part_index, name, value);
    else
      check(exr_attr_set_string(context_, part_index, name == "DateTime" ? "capDate" : name.c_str(), value.c_str()));
}

void ExrFile::add_matrix(int part_index, const std::string& name, const std::string& numbers) {
  std::istringstream text(numbers);
  exr_attr_m44f_t matrix{};
  for (float& number : matrix.m) text >> number;
  if (text) check(exr_attr_set_m44f(context_, part_index, name.c_str(), &matrix));
}

void ExrFile::end_headers(int part_count) {
  exr_set_longname_support(context_, 0);  // refused if some name needs it
  check(exr_write_header(context_));
  // Room for blocks that cannot be compressed, and their places in the file: what stays unused takes no memory, and
  // growing would take twice as much.
  constexpr std::size_t place_bytes = 20;
  std::size_t most = bytes_.size();
  for (int i = 0; i < part_count; ++i) {
    int count = 0;
    std::uint64_t block_bytes = 0;
    check(exr_get_chunk_count(context_, i, &count));
    check(exr_get_chunk_unpacked_size(context_, i, &block_bytes));
    most += std::size_t(count) * (block_bytes + place_bytes);
  }
  bytes_.reserve(most);
}

// Compressed, of `values` from the block's first on.
std::string ExrFile::encoded(const exr_chunk_info_t& block, int part_index, const ExrPart& part,
                             const float* values) const {
  Encoder encoder{context_};
  exr_encode_pipeline_t& pipeline = encoder.pipeline;
  check(exr_encoding_initialize(context_, part_index, &block, &pipeline));
  for (exr_coding_channel_info_t& channel : std::span(pipeline.channels, std::size_t(pipeline.channel_count))) {
    const auto place = std::ranges::find(part.channels, channel.channel_name) - part.channels.begin();
    channel.user_data_type = EXR_PIXEL_FLOAT;
    channel.user_bytes_per_element = sizeof(float);
    channel.user_pixel_stride = int(part.channels.size() * sizeof(float));
    channel.user_line_stride = part.rows.width * channel.user_pixel_stride;
    channel.encode_from_ptr = reinterpret_cast<const std::uint8_t*>(values + place);
  }
  check(exr_encoding_choose_default_routines(context_, part_index, &pipeline));
  pipeline.yield_until_ready_fn = nullptr;
  pipeline.write_fn = nullptr;
  check(exr_encoding_run(context_, part_index, &pipeline));
  // Readers take a block that is as long as its values for not compressed; version 3.1.5 forgets that.
  if (pipeline.compressed_bytes < pipeline.packed_bytes)
    return {static_cast<const char*>(pipeline.compressed_buffer), pipeline.compressed_bytes};
  return {static_cast<const char*>(pipeline.packed_buffer), pipeline.packed_bytes};
}

// Compressed on all threads, then handed over in the order that the library wants.
std::size_t ExrFile::add_blocks(int part_index, const ExrPart& part, int first_row) {
  int count = 0, rows = 0;
  check(exr_get_chunk_count(context_, part_index, &count));
  check(exr_get_scanlines_per_chunk(context_, part_index, &rows));
  std::vector<std::string> blocks;
  blocks.resize(std::size_t(count));
  std::atomic<std::size_t> outside{0};
  const std::size_t row_values = std::size_t(part.rows.width) * part.channels.size();
  parallel_for(blocks.size(), [&](std::size_t i) {
    exr_chunk_info_t block{};
    const int row = int(i) * rows;
    check(exr_write_scanline_chunk_info(context_, part_index, first_row + row, &block));
    std::vector<float> values(std::size_t(block.height) * row_values);
    part.rows.fill(row, row + block.height, values.data());
    if (part.half) outside += clamp_to_half(values);
    blocks[i] = encoded(block, part_index, part, values.data());
  });
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    check(
        exr_write_scanline_chunk(context_, part_index, first_row + int(i) * rows, blocks[i].data(), blocks[i].size()));
    std::string().swap(blocks[i]);
  }
  return outside;
}

}  // namespace

ExrRows::ExrRows(Image image) : width(image.width), height(image.height) {
  const std::size_t row_values = std::size_t(width) * std::size_t(image.channels);
  CHECK(image.pixels.size() == std::size_t(height) * row_values, "{} values for {} x {} x {}", image.pixels.size(),
        width, height, image.channels);
  fill = [row_values, kept = std::make_shared<const Image>(std::move(image))](int begin, int end, float* values) {
    std::copy_n(&kept->pixels[std::size_t(begin) * row_values], std::size_t(end - begin) * row_values, values);
  };
}

std::size_t write_exr_parts(const std::string& path, const std::vector<ExrPart>& parts, const ExrFrame& frame,
                            const Metadata& metadata) {
  CHECK(!parts.empty(), "an EXR file without parts");
  for (const ExrPart& part : parts)
    CHECK(part.rows.width == parts[0].rows.width && part.rows.height == parts[0].rows.height,
          "part {} has another size", part.name);
  ExrFile file(path);
  for (const ExrPart& part : parts) file.add_header(part, frame);
  file.add_metadata(0, metadata);
  file.end_headers(int(parts.size()));
  std::size_t outside = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) outside += file.add_blocks(int(i), parts[i], frame.y);
  write_file(path, file.bytes());
  return outside;
}

}  // namespace meristem
