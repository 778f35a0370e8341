#include "renderer/color/color.h"
#include "tests/renderer/image/scratch_folder.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>

namespace meristem {
namespace {

using Rgb = std::array<float, 3>;

Rgb shown(Rgb linear, const std::string& view, float exposure = 0) {
  DisplayTransform(view, exposure).apply(linear.data(), 1, 1, 3);
  return linear;
}

// IEC 61966-2-1, clause 5.2.
double srgb_transfer(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055; }

TEST(DisplayTransform, SrgbViewIsTheTransferFunctionOfTheStandard) {
  for (double x : {0.0, 0.001, 0.0031308, 0.01, 0.18, 0.5, 0.9, 1.0}) {
    const Rgb grey = shown({float(x), float(x), float(x)}, "sRGB");
    for (float channel : grey) EXPECT_NEAR(channel, srgb_transfer(x), 1e-5) << x;
  }
}

TEST(DisplayTransform, SrgbViewKeepsThePrimaries) {
  for (std::size_t i = 0; i < 3; ++i) {
    Rgb primary{};
    primary[i] = 0.5f;
    const Rgb result = shown(primary, "sRGB");
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(result[c], c == i ? srgb_transfer(0.5) : 0.0, 2e-5) << i << c;
  }
}

// Grey through the ACES 1.0 output transform for video. 18 % comes out at 10 of the 100 nits of the reference display
// (the mid-point of the RRT and of the 48-nit ODT, scaled), that is 0.1 linear and 0.349 to 0.36 encoded.
TEST(DisplayTransform, AcesShowsMiddleGreyAtATenthOfWhite) {
  const Rgb grey = shown({0.18f, 0.18f, 0.18f}, "ACES SDR");
  for (float channel : grey) {
    EXPECT_GT(channel, 0.345f);
    EXPECT_LT(channel, 0.362f);
    EXPECT_NEAR(channel, grey[0], 1e-3f);
  }
}

TEST(DisplayTransform, RawAloneShowsData) {
  EXPECT_TRUE(DisplayTransform("Raw").is_data());
  EXPECT_FALSE(DisplayTransform("sRGB").is_data());
  EXPECT_FALSE(DisplayTransform("").is_data());
}

// White of the display is reached near 16; the curve ends a little above and the file cuts that off.
TEST(DisplayTransform, AcesCompressesLightAndKeepsItsOrder) {
  float before = -1;
  for (float x : {0.0f, 0.02f, 0.18f, 1.0f, 4.0f, 16.0f, 100.0f}) {
    const float value = shown({x, x, x}, "ACES SDR")[1];
    EXPECT_GE(value, before);
    EXPECT_LE(value, 1.03f);
    before = value;
  }
  EXPECT_NEAR(shown({1, 1, 1}, "ACES SDR")[1], 0.81f, 0.01f);
  EXPECT_GT(shown({16, 16, 16}, "ACES SDR")[1], 0.99f);
}

TEST(DisplayTransform, AcesKeepsTheHueOfPrimaries) {
  for (std::size_t i = 0; i < 3; ++i) {
    Rgb primary{};
    primary[i] = 0.8f;
    const Rgb result = shown(primary, "ACES SDR");
    for (std::size_t other : {(i + 1) % 3, (i + 2) % 3}) EXPECT_LT(result[other], result[i] * 0.75f) << i;
  }
}

TEST(DisplayTransform, RawKeepsValuesAndExposureIsInStops) {
  const Rgb color{0.25f, -1.5f, 7.0f};
  EXPECT_EQ(shown(color, "Raw"), color);
  EXPECT_EQ(shown(color, "Raw", 1), (Rgb{0.5f, -3.0f, 14.0f}));
  const Rgb brighter = shown({0.09f, 0.09f, 0.09f}, "ACES SDR", 1), same = shown({0.18f, 0.18f, 0.18f}, "ACES SDR");
  EXPECT_NEAR(brighter[0], same[0], 1e-6f);
}

TEST(DisplayTransform, LeavesAlphaAlone) {
  std::array<float, 8> pixels{0.18f, 0.18f, 0.18f, 0.25f, 1, 1, 1, 0.5f};
  DisplayTransform("sRGB").apply(pixels.data(), 2, 1, 4);
  EXPECT_FLOAT_EQ(pixels[3], 0.25f);
  EXPECT_FLOAT_EQ(pixels[7], 0.5f);
  EXPECT_NEAR(pixels[4], 1.0f, 1e-5f);
}

TEST(DisplayTransform, ViewsAreNamedInAnyCaseAndUnknownOnesAreErrorsWithTheList) {
  EXPECT_EQ(DisplayTransform::views(), (std::vector<std::string>{"ACES SDR", "sRGB", "Raw"}));
  EXPECT_EQ(shown({0.5f, 0.5f, 0.5f}, "aces sdr"), shown({0.5f, 0.5f, 0.5f}, ""));
  try {
    DisplayTransform("Filmic");
    ADD_FAILURE();
  } catch (const ColorError& error) {
    EXPECT_STREQ(error.what(), "no view of the display sRGB named \"Filmic\"; known: ACES SDR, sRGB, Raw");
  }
}

// A configuration of the user's, whose only view doubles ACEScg values.
constexpr const char* doubling_config = R"(ocio_profile_version: 2
roles: {scene_linear: cg, aces_interchange: aces, default: cg}
displays:
  Monitor:
    - !<View> {name: Twice, colorspace: twice}
colorspaces:
  - !<ColorSpace> {name: aces}
  - !<ColorSpace> {name: cg, to_scene_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}}
  - !<ColorSpace> {name: twice, from_scene_reference: !<GroupTransform> {children: [
      !<BuiltinTransform> {style: ACEScg_to_ACES2065-1, direction: inverse},
      !<MatrixTransform> {matrix: [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]}]}}
)";

class EnvironmentConfig : public testing::Test {
 protected:
  void use(const std::string& text) {
    std::ofstream(path_) << text;
    ::setenv("OCIO", path_.c_str(), 1);
  }
  void TearDown() override { ::unsetenv("OCIO"); }

  const ScratchFolder folder_;
  const std::string path_ = folder_ / "config.ocio";
};

// White is the same in both spaces; the green primary of Rec.709 in ACEScg: column 2 of the matrix sRGB to AP1 (D65 to
// D60 by Bradford) as the Academy's and Lindbloom's tables give it, 0.3395, 0.9164, 0.1096.
TEST_F(EnvironmentConfig, IsHonouredWithOurWorkingSpaceConverted) {
  use(doubling_config);
  EXPECT_EQ(DisplayTransform::views(), std::vector<std::string>{"Twice"});
  const Rgb white = shown({1, 1, 1}, ""), green = shown({0, 1, 0}, "Twice");
  for (float channel : white) EXPECT_NEAR(channel, 2.0f, 1e-4f);
  EXPECT_NEAR(green[0], 2 * 0.3395f, 1e-3f);
  EXPECT_NEAR(green[1], 2 * 0.9164f, 1e-3f);
  EXPECT_NEAR(green[2], 2 * 0.1096f, 1e-3f);
}

// Configurations older than the role aces_interchange have linear Rec.709 under a name of theirs.
TEST_F(EnvironmentConfig, OfOldIsUnderstoodByTheNameOfItsSpace) {
  const auto config = [](const std::string& linear) {
    return R"(ocio_profile_version: 1
roles: {scene_linear: other, default: other}
displays:
  screen:
    - !<View> {name: Half, colorspace: half}
colorspaces:
  - !<ColorSpace> {name: other}
  - !<ColorSpace>
    name: half
    from_reference: !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}
  - !<ColorSpace>
    name: )" +
           linear + R"(
    to_reference: !<MatrixTransform> {matrix: [4, 0, 0, 0, 0, 4, 0, 0, 0, 0, 4, 0, 0, 0, 0, 1]}
)";
  };
  for (const char* name : {"Utility - Linear - sRGB", "lin_rec709", "Linear"}) {
    use(config(name));
    EXPECT_NEAR(shown({0.25f, 0.25f, 0.25f}, "")[0], 0.5f, 1e-5f) << name;
  }
  use(config("linear of sorts"));
  try {
    DisplayTransform("");
    FAIL() << "which space is ours was guessed";
  } catch (const ColorError& error) {
    EXPECT_NE(std::string(error.what()).find("does not say what linear Rec.709 is"), std::string::npos) << error.what();
  }
}

TEST_F(EnvironmentConfig, ThatIsBrokenIsAnErrorInWords) {
  use("no configuration");
  EXPECT_THROW(DisplayTransform(""), ColorError);
  use("");
  ::setenv("OCIO", "/nowhere/config.ocio", 1);
  EXPECT_THROW(DisplayTransform(""), ColorError);
}

}  // namespace
}  // namespace meristem
