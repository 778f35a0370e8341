#include "renderer/denoise/denoise.h"

#include "geometry/base/key.h"
#include "geometry/base/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace meristem {
namespace {

constexpr int width = 96, height = 64;

// What a picture is made of, without noise: a textured floor below a sky, with leaves before both, thin and round ones,
// and a shadow that no feature knows of.
struct Surface {
  Spectrum albedo, normal, light;
  Spectrum color() const { return albedo * light; }
};

Surface surface_at(float x, float y) {
  for (int i = 0; i < 25; ++i) {
    const auto random = [&](int what) { return uniform_float(hash_keys(7, Key(i), Key(what))); };
    const float dx = x - 45 - 50 * random(0), dy = y - 60 * random(1), turn = 6 * random(2);
    const float along = dx * std::cos(turn) + dy * std::sin(turn), across = dy * std::cos(turn) - dx * std::sin(turn);
    if (along * along / 64 + across * across / 6 > 1) continue;
    const Spectrum normal{std::sin(turn) * 0.6f, 0.8f, std::cos(turn) * 0.6f};
    return {{0.1f + 0.2f * random(3), 0.4f, 0.08f}, normal, Spectrum(1.5f * std::abs(normal.x) + 0.2f)};
  }
  if (y < 20) return {{}, {}, {}};
  const bool dark = (int(x / 6) + int(y / 6)) % 2 == 0;
  return {Spectrum(dark ? 0.15f : 0.6f), {0, 1, 0}, Spectrum(x < 25 && y > 40 ? 0.1f : 1.2f)};
}

Spectrum color_at(float x, float y) {
  const Surface s = surface_at(x, y);
  return s.normal == Spectrum{} ? Spectrum{0.5f + y * 0.01f, 0.7f, 1.1f} : s.color();
}

void append(Image& image, Spectrum s) { image.pixels.insert(image.pixels.end(), {s.x, s.y, s.z}); }

struct Rendered {
  denoise::Input input;
  Image noisy, truth;
};

// `samples` a pixel, each of one point in it; what it shows is there, or not, with the chance `1 / noise`, and bright
// accordingly. One sample of 3,000 is a firefly.
Rendered render(int samples, float noise) {
  const Image rgb{width, height, 3, {}};
  Rendered r{{{rgb, rgb}, {width, height, 1, {}}, rgb, rgb}, rgb, rgb};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      Spectrum half[2], albedo, normal, truth;
      double sum = 0, squares = 0;
      for (int i = 0; i < samples; ++i) {
        const auto random = [&](int what) { return uniform_float(hash_keys(Key(x), Key(y), Key(i), Key(what))); };
        const float px = float(x) + random(0), py = float(y) + random(1);
        const Surface s = surface_at(px, py);
        Spectrum light = color_at(px, py);
        truth += light;
        if (noise > 0 && s.normal != Spectrum{}) light *= random(2) * noise < 1 ? noise : 0.0f;
        if (noise > 0 && random(3) < 1 / 3000.0f) light = light * 100;
        half[i & 1] += light;
        albedo += s.albedo, normal += s.normal;
        sum += double(luminance(light)), squares += double(luminance(light) * luminance(light));
      }
      const float n = float(samples);
      append(r.input.halves[0], half[0] * (2 / n));
      append(r.input.halves[1], half[1] * (2 / n));
      append(r.noisy, (half[0] + half[1]) / n);
      append(r.truth, truth / n);
      append(r.input.albedo, albedo / n);
      append(r.input.normal, normal / n);
      const double variance = (squares - sum * sum / samples) / (samples - 1) / samples;
      r.input.variance.pixels.push_back(noise > 0 ? float(std::max(variance, 0.0)) : 0.0f);
    }
  return r;
}

// What the samples of one pixel have brought.
class PixelSamples {
 public:
  void add(Spectrum light) {
    half_[count_++ & 1] += light;
    sum_ += double(luminance(light)), squares_ += double(luminance(light)) * double(luminance(light));
  }
  // Makes it the pixel with that number.
  void put(denoise::Input& input, std::size_t pixel) const {
    for (int c = 0; c < 3; ++c)
      for (std::size_t h = 0; h < 2; ++h)
        input.halves[h].pixels[3 * pixel + std::size_t(c)] = half_[h][c] * (2.0f / float(count_));
    input.variance.pixels[pixel] = float((squares_ - sum_ * sum_ / count_) / (count_ - 1) / count_);
  }

 private:
  Spectrum half_[2];
  double sum_ = 0, squares_ = 0;
  int count_ = 0;
};

double mean_square_error(const Image& image, const Image& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < truth.pixels.size(); ++i) {
    const double error = double(image.pixels[i]) - double(truth.pixels[i]);
    sum += error * error;
  }
  return sum / double(truth.pixels.size());
}

TEST(Denoise, TakesMostOfTheNoiseAway) {
  for (const int samples : {8, 32}) {
    const Rendered r = render(samples, 3);
    const double before = mean_square_error(r.noisy, r.truth);
    const double after = mean_square_error(denoise::denoised(r.input), r.truth);
    EXPECT_LT(after, before / 6) << samples << " samples";
  }
}

TEST(Denoise, LeavesAPictureWithoutNoiseAsItIs) {
  Rendered r = render(4, 0);
  r.input.halves = {r.truth, r.truth};
  const Image image = denoise::denoised(r.input);
  ASSERT_EQ(image.pixels.size(), r.truth.pixels.size());
  for (std::size_t i = 0; i < image.pixels.size(); ++i) ASSERT_NEAR(image.pixels[i], r.truth.pixels[i], 1e-3f) << i;
}

// Far hills in haze: one path in 100 brings nearly all the light, and surfaces hardly differ. Fits are not to follow
// chance.
TEST(Denoise, RareLightOverEvenSurfacesLeavesNoSpecks) {
  constexpr int samples = 8;
  Rendered r = render(samples, 3);
  for (std::size_t i = 0; i < std::size_t(width * height); ++i) {
    const auto random = [&](std::size_t what) { return uniform_float(hash_keys(3, Key(i), Key(what))); };
    PixelSamples pixel;
    for (std::size_t n = 0; n < samples; ++n) pixel.add(Spectrum(random(n) < 1 / 100.0f ? 100.0f : 0.05f));
    pixel.put(r.input, i);
    for (std::size_t c = 0; c < 3; ++c) {
      r.input.albedo.pixels[3 * i + c] = 0.2f + 0.1f * random(20 + c);
      r.input.normal.pixels[3 * i + c] = 0.5f + 0.01f * random(30 + c);
    }
  }
  const Image image = denoise::denoised(r.input);
  double mean = 0;
  for (const float v : image.pixels) mean += double(v) / double(image.pixels.size());
  EXPECT_GT(mean, 0.4);
  const auto specks = std::ranges::count_if(image.pixels, [&](float v) { return v <= 0; });
  EXPECT_EQ(specks, 0) << "of " << image.pixels.size();
}

// Over a greenish surface whose features vary, one path in 100 brings magenta light. All that reaches a pixel is
// between the two colours, and so is what is shown, if a fit is taken in all its channels or in none.
TEST(Denoise, RareLightOfAnotherColourLeavesNoColouredSpecks) {
  constexpr int samples = 8;
  Rendered r = render(samples, 3);
  for (std::size_t i = 0; i < std::size_t(width * height); ++i) {
    const auto random = [&](std::size_t what) { return uniform_float(hash_keys(3, Key(i), Key(what))); };
    PixelSamples pixel;
    for (std::size_t n = 0; n < samples; ++n)
      pixel.add(random(n) < 1 / 100.0f ? Spectrum{200, 100, 200} : Spectrum{0.05f, 0.1f, 0.03f} * random(n + samples));
    pixel.put(r.input, i);
    for (std::size_t c = 0; c < 3; ++c) {
      r.input.albedo.pixels[3 * i + c] = 0.2f + 0.3f * random(20 + c);
      r.input.normal.pixels[3 * i + c] = 0.5f + 0.3f * random(30 + c);
    }
  }
  const Image image = denoise::denoised(r.input);
  int coloured = 0;
  for (std::size_t i = 0; i < image.pixels.size(); i += 3) {
    const float green = image.pixels[i + 1] / image.pixels[i];  // of the two colours 0.5 and 2
    coloured += !(green > 0.4f && green < 2.2f);
  }
  EXPECT_EQ(coloured, 0);
}

// Even noise around 1 on an even surface; sample n of a pixel is 300 where glint(x, y, n) says so.
template <class Glint>
Rendered even_noise(Glint glint) {
  constexpr int samples = 8;
  Rendered r = render(samples, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = std::size_t(y * width + x);
      PixelSamples pixel;
      for (std::size_t n = 0; n < samples; ++n)
        pixel.add(Spectrum(glint(x, y, n) ? 300.0f : 2 * uniform_float(hash_keys(5, Key(i), Key(n)))));
      pixel.put(r.input, i);
      for (std::size_t c = 0; c < 3; ++c) {
        r.input.albedo.pixels[3 * i + c] = 0.5f;
        r.input.normal.pixels[3 * i + c] = c == 1 ? 1.0f : 0.0f;
      }
    }
  return r;
}

// To one pixel in 400 a path has brought a glint, or one path of each half. The former is dimmed, the latter stays;
// what their samples say of noise must not let the noise around them be taken for what is there.
class GlintsOfPaths : public testing::TestWithParam<std::size_t> {};

TEST_P(GlintsOfPaths, LeaveNoNoiseAroundThem) {
  const std::size_t paths = GetParam();
  const auto steps_from_glint = [](int x, int y) { return std::max(std::abs(x % 20 - 10), std::abs(y % 20 - 10)); };
  const Rendered r = even_noise([&](int x, int y, std::size_t n) { return n < paths && steps_from_glint(x, y) == 0; });
  const Image image = denoise::denoised(r.input);
  double near = 0, far = 0;
  int near_count = 0, far_count = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double error = double(image.pixels[std::size_t(y * width + x) * 3]) - 1;
      const int steps = steps_from_glint(x, y);
      if (steps > 0 && steps < 5) near += error * error, ++near_count;
      if (steps > 7) far += error * error, ++far_count;
    }
  EXPECT_LT(near / near_count, 2 * far / far_count);
}

INSTANTIATE_TEST_SUITE_P(Denoise, GlintsOfPaths, testing::Values(1, 2));

// A sun that is smaller than a pixel: some samples of that pixel meet it; in the second case all of one half.
class SmallSun : public testing::TestWithParam<bool> {};

TEST_P(SmallSun, StaysAndLendsNoLight) {
  constexpr std::size_t samples = 8;
  const auto meets_sun = [](std::size_t n) { return GetParam() ? n % 2 == 1 : n < 5; };
  const float sun = 5e4f * (GetParam() ? 4 : 5) / samples;
  constexpr int sun_x = 40, sun_y = 30;
  Rendered r = render(samples, 0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = std::size_t(y * width + x);
      PixelSamples pixel;
      for (std::size_t n = 0; n < samples; ++n)
        pixel.add(Spectrum(x == sun_x && y == sun_y && meets_sun(n) ? 5e4f
                                                                    : 1 + 0.01f * uniform_float(hash_keys(Key(i), n))));
      pixel.put(r.input, i);
      for (std::size_t c = 0; c < 3; ++c) r.input.albedo.pixels[3 * i + c] = r.input.normal.pixels[3 * i + c] = 0;
    }
  const Image image = denoise::denoised(r.input);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float light = image.pixels[std::size_t(y * width + x) * 3];
      if (x == sun_x && y == sun_y)
        EXPECT_NEAR(light, sun, 1);
      else
        EXPECT_NEAR(light, 1.005f, 0.02f) << x << ", " << y;
    }
}

INSTANTIATE_TEST_SUITE_P(Denoise, SmallSun, testing::Bool());

// Where two fireflies are near to each other, and at the image's edge, beyond which it is repeated.
TEST(Denoise, FirefliesLeaveNoBlocks) {
  const auto brightest = [](auto glint) {
    const Image image =
        denoise::denoised(even_noise([&](int x, int y, std::size_t n) { return n == 3 && glint(x, y); }).input);
    return *std::ranges::max_element(image.pixels);
  };
  const float without = brightest([](int, int) { return false; });
  EXPECT_LT(brightest([](int x, int y) { return x % 30 == 15 && y % 30 == 15; }), 1.1f * without);
  EXPECT_LT(brightest([](int x, int y) { return (x % 30 == 15 || x % 30 == 17) && y % 30 == 15; }), 1.1f * without);
  EXPECT_LT(brightest([](int x, int y) { return x % 30 == 15 && y % (height - 1) == 0; }), 1.1f * without);
  EXPECT_LT(brightest([](int x, int y) { return x % (width - 1) == 0 && y % (height - 1) == 0; }), 1.1f * without);
}

TEST(Denoise, ThreadsDoNotMatter) {
  const Rendered r = render(8, 3);
  const auto by = [&](int threads) {
    const ThreadLimit limit(threads);
    return denoise::denoised(r.input).pixels;
  };
  EXPECT_EQ(by(1), by(3));
}

TEST(Denoise, PicturesMayBeTiny) {
  Rendered r = render(8, 3);
  const auto cut = [](Image& image) {
    image.width = 1, image.height = 2;
    image.pixels.resize(std::size_t(2 * image.channels));
  };
  for (Image* image : {&r.input.halves[0], &r.input.halves[1], &r.input.variance, &r.input.albedo, &r.input.normal})
    cut(*image);
  const Image image = denoise::denoised(r.input);
  ASSERT_EQ(image.pixels.size(), 6u);
  for (const float v : image.pixels) EXPECT_TRUE(std::isfinite(v) && v >= 0);
}

TEST(Denoise, AFilmOfTwoHalvesSaysWhatEachIs) {
  Film film({0, 0, 1, 1}, 1, denoise::wanted_aovs());
  ASSERT_TRUE(denoise::can_denoise(film));
  for (std::uint32_t i = 0; i < 16; ++i) film.add(0, 0, {.radiance = Spectrum(i & 4 ? 3.0f : 1.0f), .number = i});
  EXPECT_EQ(film.halves(0, 0)[0], Spectrum(1));
  EXPECT_EQ(film.halves(0, 0)[1], Spectrum(3));
  EXPECT_EQ(denoise::denoised(film).pixels.back(), 1);
  EXPECT_FALSE(denoise::can_denoise(Film({0, 0, 1, 1}, 1, {Aov::Albedo})));
}

}  // namespace
}  // namespace meristem
