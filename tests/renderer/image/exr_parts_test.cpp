#include "renderer/image/exr_parts.h"

#include "geometry/base/parallel.h"
#include "tests/renderer/image/scratch_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

namespace meristem {
namespace {

// Hardly to be compressed.
Image rough(int width, int height, int channels) {
  Image image{width, height, channels, {}};
  std::uint32_t state = 1;
  for (int i = 0; i < width * height * channels; ++i)
    image.pixels.push_back(std::bit_cast<float>((state = state * 747796405u + 1) >> 2));
  return image;
}

Image ramp(int width, int height, int channels, float scale) {
  Image image{width, height, channels, {}};
  for (int i = 0; i < width * height * channels; ++i) image.pixels.push_back(float(i) * scale);
  return image;
}

TEST(ExrParts, EveryPartReturnsByItsName) {
  const ScratchFolder folder;
  const Image rgba = ramp(7, 5, 4, 0.25f), depth = ramp(7, 5, 1, 1.1f);
  const std::vector<ExrPart> parts{{"beauty", {"R", "G", "B", "A"}, rgba, true}, {"Z", {"Z"}, depth, false, false}};
  EXPECT_EQ(write_exr_parts(folder / "a.exr", parts, {0, 0, 7, 5}), 0u);
  EXPECT_EQ(read_image(folder / "a.exr").pixels, rgba.pixels);  // multiples of 1/4 are exact halves
  EXPECT_EQ(read_image(folder / "a.exr", "Z").pixels, depth.pixels);
  EXPECT_THROW(read_image(folder / "a.exr", "normal"), FileError);
}

TEST(ExrParts, AnotherProgramSeesTypesNamesWindowsAndMetadata) {
  const ScratchFolder folder;
  const std::vector<ExrPart> parts{
      {"beauty", {"R", "G", "B", "A"}, ramp(6, 4, 4, 1), true, true},
      {"normal", {"normal.X", "normal.Y", "normal.Z"}, ramp(6, 4, 3, 1), false, false, {{"meristem:doc", "world"}}}};
  write_exr_parts(folder / "a.exr", parts, {10, 20, 64, 48}, {{"meristem:seed", "7"}});
  const std::string said = said_by_oiiotool(folder / "a.exr");
  for (const char* part :
       {"2 subimages", "half openexr", "channel list: R, G, B, A", "channel list: normal.X, normal.Y, normal.Z",
        "oiio:subimagename: \"beauty\"", "oiio:subimagename: \"normal\"", "pixel data origin: x=10, y=20",
        "full/display size: 64 x 48", "meristem:seed: \"7\"", "meristem:doc: \"world\""})
    EXPECT_NE(said.find(part), std::string::npos) << part << "\nin\n" << said;
}

TEST(ExrParts, MatricesOfTheCameraAreMatrices) {
  const ScratchFolder folder;
  write_exr_parts(folder / "a.exr", {{"beauty", {"R", "G", "B"}, ramp(6, 4, 3, 1)}}, {0, 0, 6, 4},
                  {{"worldToCamera", "1 0 0 0 0 1 0 0 0 0 1 0 2 3 4.5 1"}, {"worldToNDC", "no matrix"}});
  const std::string said = said_by_oiiotool(folder / "a.exr");
  EXPECT_NE(said.find("worldToCamera: 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 2, 3, 4.5, 1"), std::string::npos) << said;
  EXPECT_EQ(said.find("no matrix"), std::string::npos) << said;
}

// Blocks of 16 rows, the last one shorter; those that do not become smaller stay as they are.
TEST(ExrParts, NoiseAndManyRowsComeBack) {
  const ScratchFolder folder;
  const Image noise = rough(37, 50, 3);
  const std::vector<std::string> names{"Z", "an.unusually.long.name.of.a.channel", "B"};
  write_exr_parts(folder / "a.exr", {{"one", names, noise, false}, {"two", names, noise, false}}, {3, -5, 60, 60});
  for (const char* part : {"one", "two"}) {
    const Image read = read_image(folder / "a.exr", part);
    ASSERT_EQ(read.pixels.size(), noise.pixels.size());
    std::vector<float> expected;  // channels come in the order of their names
    for (std::size_t i = 0; i < noise.pixels.size(); i += 3)
      expected.insert(expected.end(), {noise.pixels[i + 2], noise.pixels[i], noise.pixels[i + 1]});
    EXPECT_TRUE(std::memcmp(read.pixels.data(), expected.data(), expected.size() * sizeof(float)) == 0);
  }
}

// Compressed, some of these blocks are exactly as long as before: 9 values of noise among 13, for one.
TEST(ExrParts, BlocksThatHardlyShrinkComeBack) {
  const ScratchFolder folder;
  for (int width = 13; width <= 15; ++width)
    for (int kept = 1; kept <= width; ++kept) {
      Image image = rough(width, 1, 1);
      std::fill(image.pixels.begin() + kept, image.pixels.end(), 0.0f);
      write_exr_parts(folder / "a.exr", {{"", {"Y"}, image}}, {0, 0, width, 1});
      EXPECT_EQ(read_image(folder / "a.exr").pixels, image.pixels) << kept << " of " << width;
    }
}

TEST(ExrParts, TheBytesDoNotDependOnTheThreads) {
  const ScratchFolder folder;
  const std::vector<ExrPart> parts{{"one", {"Y"}, rough(64, 300, 1), true}, {"two", {"Z"}, ramp(64, 300, 1, 0.1f)}};
  write_exr_parts(folder / "all.exr", parts, {0, 0, 64, 300});
  const ThreadLimit limit(1);
  write_exr_parts(folder / "one.exr", parts, {0, 0, 64, 300});
  EXPECT_TRUE(read_text(folder / "all.exr") == read_text(folder / "one.exr"));
}

// A block this short is not compressed: the file ends with it.
TEST(ExrParts, HalvesAreTheNearestAndOfTwoTheEvenOne) {
  const ScratchFolder folder;
  const std::vector<std::pair<float, std::uint16_t>> cases{
      {1 + 0x1p-11f, 0x3c00}, {1 + 0x1.8p-11f, 0x3c01},
      {1 + 0x3p-11f, 0x3c02}, {0x1p-24f, 0x0001},
      {-0x1.8p-24f, 0x8002},  {0x1p-25f, 0x0000},
      {65519, 0x7bff},        {std::numeric_limits<float>::quiet_NaN(), 0x7e00}};
  Image image{int(cases.size()), 1, 1, {}};
  std::string halves;
  for (const auto& [value, half] : cases) {
    image.pixels.push_back(value);
    halves.append({char(half & 255), char(half >> 8)});
  }
  EXPECT_EQ(write_exr_parts(folder / "a.exr", {{"", {"Y"}, image, true}}, {0, 0, image.width, 1}), 1u);
  EXPECT_TRUE(read_text(folder / "a.exr").ends_with(halves));
}

TEST(ExrParts, HalvesAreClampedAndCountedFloatsAreNot) {
  const ScratchFolder folder;
  const Image bright = ramp(4, 4, 1, 1e5f);
  EXPECT_EQ(write_exr_parts(folder / "a.exr", {{"beauty", {"Y"}, bright, true}}, {0, 0, 4, 4}), 15u);
  EXPECT_EQ(write_exr_parts(folder / "b.exr", {{"beauty", {"Y"}, bright, false}}, {0, 0, 4, 4}), 0u);
  EXPECT_EQ(read_image(folder / "b.exr").pixels, bright.pixels);
}

TEST(ExrParts, AFullDiskIsAnErrorAndTheOldFileStays) {
  const ScratchFolder folder;
  write_exr_parts(folder / "a.exr", {{"beauty", {"Y"}, ramp(4, 4, 1, 1)}}, {0, 0, 4, 4});
  const std::string before = read_text(folder / "a.exr");
  const FileSizeLimit limit(50);
  EXPECT_THROW(write_exr_parts(folder / "a.exr", {{"beauty", {"Y"}, ramp(4, 4, 1, 2)}}, {0, 0, 4, 4}), FileError);
  EXPECT_TRUE(read_text(folder / "a.exr") == before);
  EXPECT_EQ(folder.files(), 1u);
}

}  // namespace
}  // namespace meristem
