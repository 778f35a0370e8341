#include "renderer/image/image.h"
#include "renderer/lights/panorama.h"
#include "renderer/scene/warps.h"
#include "tests/support/component.h"

#include <gtest/gtest.h>

namespace meristem {
void register_image_environment(LightRegistry& r);

namespace {

// A black sky with one bright texel, over a dim floor.
struct ImageEnvironmentTest : testing::Test {
  static constexpr int width = 32, height = 16, bright_x = 24, bright_y = 5;

  ImageEnvironmentTest() {
    Image image;
    image.width = width;
    image.height = height;
    image.channels = 3;
    image.pixels.assign(std::size_t(width * height * 3), 0.f);
    for (int i = height / 2 * width * 3; i < width * height * 3; ++i) image.pixels[std::size_t(i)] = 0.25f;
    for (int k = 0; k < 3; ++k) image.pixels[std::size_t((bright_y * width + bright_x) * 3 + k)] = 64;
    write_image(path, image);
  }
  ~ImageEnvironmentTest() override { std::remove(path.c_str()); }
  std::unique_ptr<Light> light(const std::string& more = "") const {
    return make<Light>(register_image_environment, R"({ "file": ")" + name + "\"" + more + "}", scene);
  }
  static Vec3f direction_of(double x, double y) {  // texel coordinates
    const double angle = 2 * pi * (x / width - 0.5), polar = pi * y / height;
    return Vec3f(Vec3d{std::sin(polar) * std::sin(angle), std::cos(polar), -std::sin(polar) * std::cos(angle)});
  }

  const std::string name =
      std::string("panorama_") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".exr";
  const std::string path = testing::TempDir() + name, scene = testing::TempDir() + "scene.jsonc";
};

Vec2f spread_pair(int i) {
  const double x = 0.5 + 0.7548776662466927 * i, y = 0.5 + 0.5698402909980532 * i;
  return {float(x - std::floor(x)) * 0.999999f, float(y - std::floor(y)) * 0.999999f};
}

TEST_F(ImageEnvironmentTest, TexelsStandWhereTheManualSays) {
  const auto image = light();
  EXPECT_NEAR(image->escaped(direction_of(bright_x + 0.5, bright_y + 0.5)).radiance.x, 64, 0.1f);
  EXPECT_GT(image->escaped(normalize(Vec3f{1, 0.5f, 0})).radiance.x, 1);  // the right quarter looks towards +x
  EXPECT_EQ(image->escaped({0, 1, 0}).radiance.x, 0);
  EXPECT_NEAR(image->escaped({0, -1, 0}).radiance.x, 0.25f, 1e-3f);
}

TEST_F(ImageEnvironmentTest, RotationTurnsCounterClockwise) {
  const auto image = light(R"(, "rotation": 90)");
  EXPECT_GT(image->escaped(normalize(Vec3f{0, 0.5f, -1})).radiance.x, 1);  // from +x to -z, seen from above
}

TEST_F(ImageEnvironmentTest, PdfIntegratesToOneAndSamplesAgree) {
  const auto image = light(R"(, "rotation": 33, "intensity": 2)");
  double sum = 0, by_light = 0, uniform = 0;
  constexpr int count = 200000;
  for (int i = 0; i < count; ++i) {
    const Vec3f d = uniform_cone(2, spread_pair(i));
    sum += double(image->escaped(d).pdf);
    uniform += double(image->escaped(d).radiance.x) * 4 * pi;
    const LightSample s = image->sample({}, spread_pair(i));
    ASSERT_GT(s.pdf, 0);
    by_light += double(s.radiance.x / s.pdf);
  }
  EXPECT_NEAR(sum * 4 * pi / count, 1, 0.01);
  EXPECT_NEAR(by_light / uniform, 1, 0.01);
}

// Of fine stripes the camera sees the grey between them, if a pixel is wider than they are; bounces see stripes.
TEST_F(ImageEnvironmentTest, TheCameraSeesTheMeanOverItsPixel) {
  Image stripes;
  stripes.width = 2048, stripes.height = 1024, stripes.channels = 3;
  for (int y = 0; y < stripes.height; ++y)
    for (int x = 0; x < stripes.width; ++x)
      for (int k = 0; k < 3; ++k) stripes.pixels.push_back((x / 2 + y / 2) % 2 ? 1.f : 0.f);
  write_image(path, stripes);
  const auto image = light(), sharp = light(R"(, "filter": 0)");
  EXPECT_TRUE(image->has_texture());
  EXPECT_FALSE(sharp->has_texture());
  const float pixel = 0.1f;  // 32 texels
  double variance = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3f d = uniform_cone(2, spread_pair(i));
    EXPECT_NEAR(image->background(d, pixel).x, 0.5f, 0.02f) << d.y;
    EXPECT_EQ(image->background(d, 1e-4f), image->escaped(d).radiance);
    EXPECT_EQ(sharp->background(d, pixel), sharp->escaped(d).radiance);
    variance += std::pow(double(image->escaped(d).radiance.x) - 0.5, 2) / 1000;
  }
  EXPECT_GT(variance, 0.05);
}

TEST(Panorama, MeansKeepTheLight) {
  // Odd sides, bright dots everywhere
  constexpr int width = 101, height = 51;
  std::vector<Spectrum> texels(std::size_t(width * height), Spectrum(0.1f));
  for (std::size_t i = 0; i < texels.size(); i += 37) texels[i] = {4, 2, 8};
  const Panorama panorama(texels, width, height);
  for (float angle : {0.f, 0.1f, 0.5f, 1.5f}) {
    Vec3d sum, exact;
    constexpr int count = 100000;
    for (int i = 0; i < count; ++i) {
      const Vec2f random = spread_pair(i), place{random.x, std::acos(1 - 2 * random.y) / pi_f};  // even by solid angle
      sum += Vec3d(panorama.mean(place, angle)) / count;
      exact += Vec3d(panorama.at(place)) / count;
    }
    EXPECT_NEAR(sum.z / exact.z, 1, 0.02) << angle;
  }
  const Panorama even(std::vector<Spectrum>(15, Spectrum(3.f)), 5, 3);
  for (float angle : {0.f, 1.f, 10.f}) EXPECT_NEAR(even.mean({0.99f, 0.02f}, angle).x, 3, 1e-5f);
}

TEST_F(ImageEnvironmentTest, MissingFilesAreErrorsOfTheScene) {
  EXPECT_THROW(make<Light>(register_image_environment, R"({ "file": "no/such/panorama.exr" })"), SceneErrors);
  EXPECT_NO_THROW(light());
  EXPECT_THROW(make<Light>(register_image_environment, R"({ "file": ")" + path + "\" }", scene), SceneErrors);
}

}  // namespace
}  // namespace meristem
