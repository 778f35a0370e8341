// Images in memory, and reading and writing files. PNG and EXR are written here (png_encoder.h, exr_parts.h); all else
// OpenImageIO does, in a module that is opened at first use (image_codec.h).
//
// Reading: EXR, PNG, JPEG, Radiance HDR and TIFF, told apart by their first bytes, never by their names. Only regular
// files, at most 65536 pixels a side, 64 channels and 2 GiB decoded, all checked before a pixel is read. Values are
// those of the file: integers scaled to [0, 1], no colour conversion, alpha not multiplied in. Of a multi-part file
// the first part is read, or the one named; of a cropped EXR the data window.
// Writing: EXR, PNG, JPEG and TIFF by extension; the file appears whole or not at all (atomic_file.h).
// Any thread; every error is a FileError that names the file.
#pragma once

#include "renderer/image/atomic_file.h"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace meristem {

// Rows from the top, pixels from the left, channels interleaved: RGB, RGBA, or whatever the file has.
struct Image {
  int width = 0, height = 0, channels = 0;
  std::vector<float> pixels;
};

Image read_image(const std::string& path, const std::string& part = "");

// Names and values. In EXR files "DateTime" gets its name there, and "worldToCamera" and "worldToNDC", 16 numbers each,
// are matrices.
using Metadata = std::vector<std::pair<std::string, std::string>>;

enum class ImageFormat { Exr, Png, Jpeg, Tiff };

// The format that the extension names, in either case; throws a FileError that lists the known ones.
ImageFormat image_format(const std::string& path);

struct WriteOptions {
  bool half = true;     // EXR: 16-bit halves; else 32-bit floats
  int bits = 8;         // PNG and TIFF: 8 or 16 a channel; JPEG always has 8
  bool dither = false;  // to 8 bits, for pictures to look at; data are better rounded (quantizer.h)
  int x0 = 0, y0 = 0;   // of the image's first pixel in the frame: a crop is dithered as the whole
};

// Writes 1 (grey), 3 (RGB) or 4 (RGBA) channels. EXR takes scene-linear Rec.709 with alpha multiplied in; the others
// take display values, which are clamped to [0, 1], and leave alpha away. Returns how many values lay outside the range
// of a half and were clamped to it (0 for all other formats).
std::size_t write_image(const std::string& path, const Image& image, const Metadata& metadata = {},
                        const WriteOptions& options = {});

// Whether writing such files needs the module.
bool needs_module(ImageFormat format);
// Throws the FileError that using the module would meet if it is missing.
void check_image_module();
// Opens the module, which takes some 0.5 s, so that the next call does not have to. What fails is left for that call.
void open_image_module() noexcept;

}  // namespace meristem
