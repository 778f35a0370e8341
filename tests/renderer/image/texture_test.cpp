#include "renderer/image/texture.h"

#include "renderer/image/image.h"
#include "tests/renderer/image/scratch_folder.h"

#include <gtest/gtest.h>

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

TEST(Texture, RefusesWhatIsNotAnImage) {
  const ScratchFolder folder;
  EXPECT_THROW(open_texture(folder / "none.png", {}), FileError);
  write_file(folder / "a.png", "no image at all, but long enough");
  EXPECT_THROW(open_texture(folder / "a.png", {}), FileError);
}

}  // namespace
}  // namespace meristem
