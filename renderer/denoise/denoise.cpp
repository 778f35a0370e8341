#include "renderer/denoise/denoise.h"

#include "geometry/base/check.h"
#include "geometry/base/parallel.h"
#include "renderer/denoise/outliers.h"
#include "renderer/denoise/regression.h"
#include "renderer/denoise/weights.h"

#include <algorithm>
#include <cmath>

namespace meristem::denoise {

namespace {

// What is taken for noise when surroundings are compared: 1 smooths shadows that nothing but light draws, 0.5 leaves
// grain. Chosen by eye on foliage, rust and grained wood.
constexpr float strictness = 0.7f;

Plane plane_of(const Image& image, int channel) {
  Plane plane(image.width, image.height);
  const float* from = image.pixels.data() + channel;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x, from += image.channels) plane.row(y)[x] = *from;
  plane.extend();
  return plane;
}

Color color_of(const Image& image) { return {plane_of(image, 0), plane_of(image, 1), plane_of(image, 2)}; }

// The variance of a half's pixels. That of the samples is known pixel by pixel, but is of luminance and knows nothing
// of how well the samples were spread; the difference of the halves knows both, but is itself very noisy. So the
// former is scaled by the ratio of both over a neighbourhood (Bitterli et al. 2016, section 5.1). Each pixel counts
// there in shares of the variance near it: else a single bright one, whose halves happen to agree, would make all the
// neighbourhood seem free of noise.
std::array<Plane, 3> variance_of_half(const std::array<Color, 2>& halves, const Plane& of_samples) {
  constexpr int radius = 5;
  const Plane near = box_mean(of_samples, 1);
  const auto share = [&](float variance, int x, int y) { return near.at(x, y) > 0 ? variance / near.at(x, y) : 0; };
  Plane samples(of_samples.width(), of_samples.height());
  for_pixels(samples, [&](int x, int y) { samples.row(y)[x] = share(of_samples.at(x, y), x, y); });
  samples.extend();
  const Plane samples_around = box_mean(samples, radius);
  std::array<Plane, 3> result;
  for (std::size_t c = 0; c < 3; ++c) {
    Plane difference(of_samples.width(), of_samples.height());
    for_pixels(of_samples, [&](int x, int y) {
      const float d = halves[0][c].at(x, y) - halves[1][c].at(x, y);
      difference.row(y)[x] = share(0.5f * d * d, x, y);
    });
    difference.extend();
    const Plane halves_around = box_mean(difference, radius);
    result[c] = Plane(of_samples.width(), of_samples.height());
    for_pixels(of_samples, [&](int x, int y) {
      const float around = samples_around.at(x, y);
      const float ratio = around > 0 ? halves_around.at(x, y) / around : 0;
      result[c].row(y)[x] = ratio * 0.5f * (of_samples.at(x, y) + near.at(x, y));
    });
    result[c].extend();
  }
  return result;
}

// The noise of pixels, relative to their light.
Plane stiffness_of(const std::array<Color, 2>& halves, const std::array<Plane, 3>& variance) {
  Plane result(variance[0].width(), variance[0].height());
  for_pixels(result, [&](int x, int y) {
    float noise = 0, light = 1e-6f;
    for (std::size_t c = 0; c < 3; ++c) {
      const float mean = 0.5f * (halves[0][c].at(x, y) + halves[1][c].at(x, y));
      noise += variance[c].at(x, y), light += mean * mean;
    }
    result.row(y)[x] = noise / light;
  });
  result.extend();
  return result;
}

std::vector<Tile> tiles_of(int width, int height) {
  std::vector<Tile> tiles;
  for (int y = 0; y < height; y += tile_height)
    for (int x = 0; x < width; x += tile_width) tiles.push_back({x, y});
  return tiles;
}

}  // namespace

Image denoised(const Input& input) {
  std::array<Color, 2> halves{color_of(input.halves[0]), color_of(input.halves[1])};
  Plane of_samples = plane_of(input.variance, 0);
  Features features;
  for (int c = 0; c < 3; ++c) {
    features[std::size_t(c)] = plane_of(input.albedo, c);
    features[std::size_t(3 + c)] = plane_of(input.normal, c);
  }
  const std::vector<LightPixel> lights = take_out_lights(features, halves, of_samples);
  dim_fireflies(halves, of_samples);
  const int width = halves[0][0].width(), height = halves[0][0].height();
  const std::array<Plane, 3> variance = variance_of_half(halves, of_samples);
  const Plane stiffness = stiffness_of(halves, variance);
  const std::array<Guide, 2> guides{Guide{halves[0], variance}, Guide{halves[1], variance}};
  std::array<Color, 2> fitted;
  for (Color& color : fitted)
    for (Plane& plane : color) plane = Plane(width, height);
  const std::vector<Tile> tiles = tiles_of(width, height);
  parallel_for(tiles.size(), [&](std::size_t i) {
    std::array<std::vector<float>, 2> weights;
    for (std::size_t h = 0; h < 2; ++h) {
      weights[h].resize(std::size_t(window_size * tile_width * tile_height));
      find_weights(guides[h], tiles[i], strictness, weights[h].data());
    }
    fit_tile(halves, features, stiffness, tiles[i], {weights[0].data(), weights[1].data()}, fitted);
  });
  Image result{width, height, 3, {}};
  result.pixels.reserve(std::size_t(width) * std::size_t(height) * 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (std::size_t c = 0; c < 3; ++c)
        result.pixels.push_back(0.5f * (fitted[0][c].at(x, y) + fitted[1][c].at(x, y)));
  for (const LightPixel& light : lights)
    for (int c = 0; c < 3; ++c)
      result.pixels[(std::size_t(light.y) * std::size_t(width) + std::size_t(light.x)) * 3 + std::size_t(c)] =
          light.color[c];
  return result;
}

const std::vector<Aov>& wanted_aovs() {
  static const std::vector<Aov> aovs{Aov::Albedo, Aov::Normal, Aov::Variance, Aov::SecondHalf};
  return aovs;
}

bool can_denoise(const Film& film) {
  return std::ranges::all_of(wanted_aovs(), [&](Aov aov) { return std::ranges::count(film.aovs(), aov) > 0; });
}

Image denoised(const Film& film) {
  const PixelWindow& w = film.window();
  Input input;
  for (Image& half : input.halves) half = {w.width(), w.height(), 3, {}};
  for (int y = w.y0; y < w.y1; ++y)
    for (int x = w.x0; x < w.x1; ++x) {
      const std::array<Spectrum, 2> halves = film.halves(x, y);
      for (std::size_t h = 0; h < 2; ++h)
        for (int c = 0; c < 3; ++c) input.halves[h].pixels.push_back(halves[h][c]);
    }
  input.variance = film.develop(Aov::Variance);
  input.albedo = film.develop(Aov::Albedo);
  input.normal = film.develop(Aov::Normal);
  const Image colors = denoised(input);
  Image result = film.develop();
  for (std::size_t i = 0; i < result.pixels.size() / 4; ++i)
    std::copy_n(&colors.pixels[i * 3], 3, &result.pixels[i * 4]);
  return result;
}

}  // namespace meristem::denoise
