#include "renderer/image/texture.h"

#include "renderer/image/image.h"
#include "tests/renderer/image/scratch_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace meristem {
namespace {

// 4 x 2 texels: red counts columns, green rows from the top, blue is 0.5.
Image counting() {
  Image image{4, 2, 3, {}};
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x)
      for (const float v : {float(x) / 4, float(y) / 2, 0.5f}) image.pixels.push_back(v);
  return image;
}

TEST(Texture, TexelsStandWithVUp) {
  const ScratchFolder folder;
  write_image(folder / "a.exr", counting(), {}, {.half = false});
  const auto texture = open_texture(folder / "a.exr", {});
  EXPECT_EQ(texture->at({0.125f, 0.25f}), (Vec3f{0, 0.5f, 0.5f}));                   // lower left
  EXPECT_EQ(texture->at({0.875f, 0.75f}), (Vec3f{0.75f, 0, 0.5f}));                  // upper right
  EXPECT_LT(length(texture->at({0.5f, 0.5f}) - Vec3f{0.375f, 0.25f, 0.5f}), 1e-6f);  // between four
}

TEST(Texture, WrapsAsAsked) {
  const ScratchFolder folder;
  write_image(folder / "a.exr", counting(), {}, {.half = false});
  auto red = [&](TextureWrap wrap, float u) {
    return open_texture(folder / "a.exr", {.wrap = wrap})->at({u, 0.75f}).x;
  };
  EXPECT_FLOAT_EQ(red(TextureWrap::Repeat, 3.375f), 0.25f);
  EXPECT_FLOAT_EQ(red(TextureWrap::Repeat, -0.125f), 0.75f);
  EXPECT_FLOAT_EQ(red(TextureWrap::Clamp, 1.375f), 0.75f);
  EXPECT_FLOAT_EQ(red(TextureWrap::Mirror, 1.125f), 0.75f);
  EXPECT_FLOAT_EQ(red(TextureWrap::Black, 1.375f), 0);
}

// IEC 61966-2-1: the code value 188 of 255 is half of white.
TEST(Texture, WholeNumbersAreSrgbUnlessSaidOtherwise) {
  const ScratchFolder folder;
  write_image(folder / "a.png", Image{2, 2, 1, std::vector<float>(4, 188 / 255.f)});
  EXPECT_NEAR(open_texture(folder / "a.png", {})->at({0.5f, 0.5f}).y, 0.5, 0.005);
  const auto raw = open_texture(folder / "a.png", {.encoding = TextureEncoding::Linear});
  EXPECT_NEAR(raw->at({0.5f, 0.5f}).y, 188 / 255.0, 1e-6);
}

// Of black and white the mean is half of the light, not half of the code values; of odd sizes too.
TEST(Texture, AFootprintIsAMeanOfLight) {
  const ScratchFolder folder;
  for (const int width : {64, 60}) {
    Image stripes{width, 48, 1, {}};
    for (int i = 0; i < width * 48; ++i) stripes.pixels.push_back(float(i % width / 2 % 2));
    const std::string file = folder / (std::to_string(width) + ".png");
    write_image(file, stripes);
    const auto texture = open_texture(file, {});
    const float texel = 1 / float(width);
    EXPECT_EQ(texture->at({2.5f * texel, 0.3f}).x, 1);
    // Across the stripes, aslant, much longer than wide, and much larger than the image
    for (const TextureFootprint& f : {TextureFootprint{{8 * texel, 0}, {0, 8 * texel}},
                                      TextureFootprint{{6 * texel, 6 * texel}, {-6 * texel, 6 * texel}},
                                      TextureFootprint{{12 * texel, 0}, {0, texel}}, TextureFootprint{{7, 1}, {-1, 7}}})
      for (const float u : {0.1f, 0.37f, 0.9f})
        EXPECT_NEAR(texture->mean({u, 0.6f}, f).x, 0.5, 0.03) << width << ", " << f.side_a.x << ", " << u;
    // Along them nothing is to be blurred
    EXPECT_NEAR(texture->mean({3 * texel, 0.5f}, {{0.2f * texel, 0}, {0, 0.1f}}).x, 1, 0.2);
    EXPECT_EQ(texture->mean({0.4f, 0.5f}, {{NAN, 0}, {0, 0.1f}}), texture->at({0.4f, 0.5f}));
  }
}

TEST(Texture, AlphaDoesNotDimColours) {
  const ScratchFolder folder;
  write_image(folder / "a.png", Image{1, 1, 4, {1, 1, 1, 0.25f}});
  for (const TextureEncoding encoding : {TextureEncoding::Srgb, TextureEncoding::Linear})
    EXPECT_EQ(open_texture(folder / "a.png", {.encoding = encoding})->at({0.5f, 0.5f}).y, 1);
}

TEST(Texture, AFileThatBreaksOffIsAFault) {
  const ScratchFolder folder;
  Image image{64, 64, 3, std::vector<float>(64 * 64 * 3)};
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = float(i * 7919 % 256) / 255;
  write_image(folder / "whole.png", image, {}, {});
  const std::string bytes = read_text(folder / "whole.png");
  write_file(folder / "half.png", bytes.substr(0, bytes.size() / 2));
  const auto faults_of = [&](const std::string& file) {
    return std::ranges::count_if(texture_faults(), [&](const std::string& f) { return f.find(file) != f.npos; });
  };
  open_texture(folder / "whole.png", {})->at({0.5f, 0.1f});
  EXPECT_EQ(faults_of("whole.png"), 0);
  const auto half = open_texture(folder / "half.png", {});
  EXPECT_EQ(faults_of("half.png"), 0) << "nothing has been looked up yet";
  for (const float u : {0.2f, 0.5f, 0.8f}) EXPECT_EQ(half->at({u, 0.1f}).x, 0);
  EXPECT_EQ(faults_of("half.png"), 1);
}

TEST(Texture, RefusesWhatIsNotAnImage) {
  const ScratchFolder folder;
  EXPECT_THROW(open_texture(folder / "none.png", {}), FileError);
  write_file(folder / "a.png", "no image at all, but long enough");
  EXPECT_THROW(open_texture(folder / "a.png", {}), FileError);
}

}  // namespace
}  // namespace meristem
