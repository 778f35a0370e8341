// DecodedInput: an image file in sRGB as OpenImageIO's cache is to see it: scene-linear, so that its coarser images are
// means of light and not of code values. At most three channels; no metadata.
#pragma once

#include <OpenImageIO/imageio.h>

#include <memory>
#include <string>

namespace meristem {

class DecodedInput final : public OIIO::ImageInput {
 public:
  static constexpr const char* prefix = "srgb:";  // of the name: the file's path follows

  const char* format_name() const override { return "decoded"; }
  bool open(const std::string& name, OIIO::ImageSpec& spec) override;
  bool close() override;
  bool read_native_scanline(int subimage, int miplevel, int y, int z, void* data) override {
    return read_native_scanlines(subimage, miplevel, y, y + 1, z, data);
  }
  bool read_native_scanlines(int subimage, int miplevel, int begin, int end, int z, void* data) override;

 private:
  bool read_rows(int begin, int end, float* rows);

  std::unique_ptr<OIIO::ImageInput> file_;
};

}  // namespace meristem
