#include "renderer/image/image.h"

#include "tests/renderer/image/scratch_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

namespace meristem {
namespace {

Image gradient(int width, int height, int channels) {
  Image image{width, height, channels, {}};
  for (int i = 0; i < width * height * channels; ++i) image.pixels.push_back(float((i * 37) % 257) / 256.0f);
  return image;
}

// Noise does not compress: the file is about as large as its pixels.
Image noise(int width, int height) {
  Image image{width, height, 3, {}};
  std::uint32_t state = 1;
  for (int i = 0; i < width * height * 3; ++i)
    image.pixels.push_back(float((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-24f);
  return image;
}

std::string error_of_reading(const std::string& path) {
  try {
    read_image(path);
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

TEST(Image, FloatExrReturnsTheSameBits) {
  const ScratchFolder folder;
  Image image = gradient(33, 17, 4);
  image.pixels[5] = -3.25e20f;
  image.pixels[6] = 1e-30f;
  EXPECT_EQ(write_image(folder / "a.exr", image, {}, {.half = false}), 0u);
  const Image read = read_image(folder / "a.exr");
  EXPECT_EQ(read.width, 33);
  EXPECT_EQ(read.height, 17);
  EXPECT_EQ(read.channels, 4);
  EXPECT_EQ(read.pixels, image.pixels);
}

TEST(Image, HalfExrRoundsToElevenBitsAndClampsItsRange) {
  const ScratchFolder folder;
  Image image = gradient(8, 8, 3);
  image.pixels[0] = 1e6f;
  image.pixels[1] = -std::numeric_limits<float>::infinity();
  EXPECT_EQ(write_image(folder / "a.exr", image), 2u);
  const Image read = read_image(folder / "a.exr");
  EXPECT_EQ(read.pixels[0], 65504.0f);
  EXPECT_EQ(read.pixels[1], -65504.0f);
  for (std::size_t i = 2; i < image.pixels.size(); ++i)
    EXPECT_NEAR(read.pixels[i], image.pixels[i], image.pixels[i] * 0x1p-11f + 0x1p-25f) << i;
}

TEST(Image, IntegerFormatsRoundToTheNearestStep) {
  const ScratchFolder folder;
  const Image image = gradient(19, 11, 3);
  for (const char* name : {"a.png", "a.tif"})
    for (int bits : {8, 16}) {
      write_image(folder / name, image, {}, {.bits = bits});
      const Image read = read_image(folder / name);
      ASSERT_EQ(read.pixels.size(), image.pixels.size());
      const float half_step = 0.5001f / float((1 << bits) - 1);
      for (std::size_t i = 0; i < image.pixels.size(); ++i)
        EXPECT_NEAR(read.pixels[i], std::min(image.pixels[i], 1.0f), half_step);
    }
}

// Rows that each filter suits: constant, growing to the right, growing downwards, a slope, noise. And an odd width.
TEST(Image, PngsOfAllKindsOfRowsComeBack) {
  const ScratchFolder folder;
  for (const int channels : {1, 3}) {
    Image image{101, 60, channels, {}};
    const Image rough = noise(101, 60);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < channels; ++c) {
          const int kind = y / 12;
          const int step = kind == 0 ? 77 : kind == 1 ? x : kind == 2 ? 3 * y : kind == 3 ? x + y + c : 0;
          image.pixels.push_back(kind == 4 ? rough.pixels[std::size_t(y * 101 + x)] : float(step) / 255);
        }
    write_image(folder / "a.png", image);
    const Image read = read_image(folder / "a.png");
    ASSERT_EQ(read.pixels.size(), image.pixels.size());
    for (std::size_t i = 0; i < image.pixels.size(); ++i) EXPECT_NEAR(read.pixels[i], image.pixels[i], 0.51f / 255);
  }
}

TEST(Image, PngTakesWhatIsNoNumberForBlack) {
  const ScratchFolder folder;
  write_image(folder / "a.png", {2, 2, 1, {std::numeric_limits<float>::quiet_NaN(), -1, 2, 1}});
  EXPECT_EQ(read_image(folder / "a.png").pixels, (std::vector<float>{0, 0, 1, 1}));
}

TEST(Image, APngTooWideForTheLibraryIsAnErrorWithItsReason) {
  const ScratchFolder folder;
  constexpr int width = 1'000'001;
  try {
    write_image(folder / "a.png", {width, 1, 1, std::vector<float>(width)});
    ADD_FAILURE();
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("a.png: Invalid IHDR data"), std::string::npos) << error.what();
  }
  EXPECT_EQ(folder.files(), 0u);
}

TEST(Image, AnotherProgramSeesWhatAPngSaysOfItself) {
  const ScratchFolder folder;
  write_image(folder / "a.png", gradient(4, 4, 3),
              {{"DateTime", "2026:11:29 19:57:29"}, {"meristem:seed", "7"}, {"meristem:scene", "Wald & B\xc3\xa4ume"}});
  const std::string said = said_by_oiiotool(folder / "a.png");
  for (const char* part : {"uint8 png", "oiio:ColorSpace: \"sRGB\"", "DateTime: \"2026:11:29 19:57:29\"",
                           "meristem:seed: \"7\"", "meristem:scene: \"Wald & B\xc3\xa4ume\""})
    EXPECT_NE(said.find(part), std::string::npos) << part << "\nin\n" << said;
}

TEST(Image, JpegIsCloseAndDisplayFormatsLeaveAlphaAway) {
  const ScratchFolder folder;
  Image image{16, 16, 4, {}};
  for (int i = 0; i < 256; ++i) image.pixels.insert(image.pixels.end(), {0.5f, 0.25f, 0.75f, 0.1f});
  for (const char* name : {"a.jpg", "a.png"}) {
    write_image(folder / name, image);
    const Image read = read_image(folder / name);
    ASSERT_EQ(read.channels, 3);
    EXPECT_NEAR(read.pixels[0], 0.5f, 0.02f);
    EXPECT_NEAR(read.pixels[1], 0.25f, 0.02f);
    EXPECT_NEAR(read.pixels[2], 0.75f, 0.02f);
  }
}

TEST(Image, TheContentDecidesNotTheName) {
  const ScratchFolder folder;
  const Image image = gradient(4, 4, 3);
  write_image(folder / "a.exr", image, {}, {.half = false});
  std::filesystem::rename(folder / "a.exr", folder / "a.png");
  EXPECT_EQ(read_image(folder / "a.png").pixels, image.pixels);
}

TEST(Image, WhatIsNoImageIsRefusedInWords) {
  const ScratchFolder folder;
  write_file(folder / "text.exr", "hello");
  write_file(folder / "empty.png", "");
  EXPECT_NE(error_of_reading(folder / "text.exr").find("not an EXR"), std::string::npos);
  EXPECT_NE(error_of_reading(folder / "empty.png").find("not an EXR"), std::string::npos);
  EXPECT_NE(error_of_reading(folder / "missing.png").find("no such file"), std::string::npos);
  EXPECT_NE(error_of_reading("/dev/zero").find("not a regular file"), std::string::npos);
}

TEST(Image, ATruncatedFileIsAnError) {
  const ScratchFolder folder;
  for (const char* name : {"a.exr", "a.png", "a.tif"}) {
    write_image(folder / name, noise(64, 64));
    const std::string whole = read_text(folder / name);
    write_file(folder / name, whole.substr(0, whole.size() / 2));
    EXPECT_NE(error_of_reading(folder / name), "") << name;
  }
}

// A PNG that claims 60000 x 60000 RGB pixels and holds one byte; its check sums are right.
TEST(Image, AnImageBombIsRefusedBeforeItIsDecoded) {
  const ScratchFolder folder;
  using namespace std::string_literals;
  const std::string header =
      "\x89PNG\r\n\x1a\n"s
      "\0\0\0\x0dIHDR"s
      "\0\0\xea\x60\0\0\xea\x60\x08\x02\0\0\0"s
      "\x0f\xb0\xe2\x15"s;
  const std::string data =
      "\0\0\0\x09IDAT\x78\x9c\x63\0\0\0\x01\0\x01"s
      "\x5e\xff\x7d\xf9"s;
  write_file(folder / "bomb.png", header + data);
  EXPECT_NE(error_of_reading(folder / "bomb.png").find("MiB decoded"), std::string::npos)
      << error_of_reading(folder / "bomb.png");
}

// The bytes that the image has as a file of that name.
std::uintmax_t size_as_file(const ScratchFolder& folder, const std::string& name, const Image& image) {
  const std::string path = folder / "sized-" + name;
  write_image(path, image);
  const std::uintmax_t bytes = std::filesystem::file_size(path);
  std::filesystem::remove(path);
  return bytes;
}

// With room for nothing, for a part, and for all but a byte: libraries that buffer lose the error at some of them.
// (TIFF goes through a memory file, for which this limit holds too, and libtiff loses its last byte in silence: half is
// tried there.)
TEST(Image, AFullDiskIsAnErrorAndLeavesTheOldFile) {
  const ScratchFolder folder;
  for (const std::string& name :
       {std::string("a.exr"), std::string("a.png"), std::string("a.jpg"), std::string("a.tif")}) {
    write_image(folder / name, gradient(4, 4, 3));
    const std::string old = read_text(folder / name);
    const std::size_t files = folder.files();
    for (const Image& image : {noise(8, 8), noise(128, 128)}) {
      const std::uintmax_t whole = size_as_file(folder, name, image);
      for (const std::uintmax_t room : {std::uintmax_t(0), whole / 10, name == "a.tif" ? whole / 2 : whole - 1}) {
        const FileSizeLimit limit(room);
        EXPECT_THROW(write_image(folder / name, image), FileError) << name << " " << room << " of " << whole;
      }
    }
    EXPECT_TRUE(read_text(folder / name) == old) << name;
    EXPECT_EQ(folder.files(), files) << name;
  }
}

TEST(Image, UnknownExtensionsAndFoldersAreErrors) {
  const ScratchFolder folder;
  EXPECT_THROW(write_image(folder / "a.gif", gradient(4, 4, 3)), FileError);
  EXPECT_THROW(write_image(folder / "missing/a.png", gradient(4, 4, 3)), FileError);
  EXPECT_EQ(image_format("A.PNG"), ImageFormat::Png);
  EXPECT_EQ(folder.files(), 0u);
}

}  // namespace
}  // namespace meristem
