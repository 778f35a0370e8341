#include "renderer/denoise/outliers.h"

#include <algorithm>
#include <cmath>

namespace meristem::denoise {

namespace {

float luminance_at(const Color& c, int x, int y) { return luminance({c[0].at(x, y), c[1].at(x, y), c[2].at(x, y)}); }

// The pixel of middle luminance around one, and that luminance, as a mean of the halves.
struct Middle {
  int x, y;
  float luminance;
};

Middle middle_around(const std::array<Color, 2>& halves, int x, int y) {
  constexpr int radius = 3, side = 2 * radius + 1;
  std::array<Middle, std::size_t(side * side)> around;
  for (int i = 0; i < side * side; ++i) {
    const int ax = x + i % side - radius, ay = y + i / side - radius;
    around[std::size_t(i)] = {ax, ay, 0.5f * (luminance_at(halves[0], ax, ay) + luminance_at(halves[1], ax, ay))};
  }
  std::ranges::nth_element(around, around.begin() + side * side / 2, {}, &Middle::luminance);
  return around[side * side / 2];
}

// How bright a picture is, in which few pixels, however bright, do not count.
float level_of(const std::array<Color, 2>& halves) {
  const Plane& plane = halves[0][0];
  double roots = 0;
  for (int y = 0; y < plane.height(); ++y)
    for (int x = 0; x < plane.width(); ++x)
      roots += double(std::sqrt(std::max(luminance_at(halves[0], x, y) + luminance_at(halves[1], x, y), 0.0f)));
  const double mean = roots / (double(plane.width()) * plane.height());
  return float(0.5 * mean * mean);
}

// Of two fireflies near to each other each is part of the other's surroundings: one pass dims both to half, two to a
// fifth. More take away too much of light that only rare paths bring.
constexpr int dimming_passes = 2;

void dim_once(std::array<Color, 2>& halves, Plane& variance) {
  constexpr int radius = 2;
  constexpr float deviations = 3;
  const std::array<Color, 2> before = halves;
  const int width = variance.width(), height = variance.height();
  for_pixels(before[0][0], [&](int x, int y) {
    float sum = 0, squares = 0;
    int count = 0;
    for (int dy = -radius; dy <= radius; ++dy)
      for (int dx = -radius; dx <= radius; ++dx) {
        const bool itself = std::clamp(x + dx, 0, width - 1) == x && std::clamp(y + dy, 0, height - 1) == y;
        if (itself) continue;
        for (const Color& half : before) {
          const float l = luminance_at(half, x + dx, y + dy);
          sum += l, squares += l * l, ++count;
        }
      }
    const float mean = sum / float(count);
    const float deviation = std::sqrt(std::max(squares / float(count) - mean * mean, 0.0f));
    for (std::size_t h = 0; h < 2; ++h) {
      const float own = luminance_at(before[h], x, y), other = luminance_at(before[1 - h], x, y);
      const float limit = std::max(mean + deviations * deviation, other);
      if (own <= limit) continue;
      const float factor = limit / own;
      for (Plane& plane : halves[h]) plane.row(y)[x] *= factor;
      variance.row(y)[x] *= factor * factor;
    }
  });
  variance.extend();
  for (Color& half : halves)
    for (Plane& plane : half) plane.extend();
}

}  // namespace

std::vector<LightPixel> take_out_lights(const Features& features, std::array<Color, 2>& halves, Plane& variance) {
  constexpr float times = 100;
  const float level = level_of(halves);
  const int width = variance.width(), height = variance.height();
  std::array<Plane, 2> bright{Plane(width, height), Plane(width, height)};  // 1 where a half is
  for_pixels(variance, [&](int x, int y) {
    const std::array<float, 2> own{luminance_at(halves[0], x, y), luminance_at(halves[1], x, y)};
    if (!(std::max(own[0], own[1]) > times * level)) return;
    const float limit = times * std::max(level, middle_around(halves, x, y).luminance);
    for (std::size_t h = 0; h < 2; ++h) bright[h].row(y)[x] = float(own[h] > limit);
  });
  for (Plane& plane : bright) plane.extend();
  const std::array<Plane, 2> near{box_mean(bright[0], 1), box_mean(bright[1], 1)};
  const auto shows_surface = [&](int x, int y) {
    return std::ranges::any_of(features, [&](const Plane& feature) { return feature.at(x, y) != 0; });
  };
  const std::array<Color, 2> before = halves;
  std::vector<LightPixel> lights;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (bright[0].at(x, y) + bright[1].at(x, y) == 0) continue;
      if (shows_surface(x, y) && (near[0].at(x, y) == 0 || near[1].at(x, y) == 0)) continue;
      const Middle as = middle_around(before, x, y);
      LightPixel& light = lights.emplace_back(LightPixel{x, y, {}});
      for (std::size_t c = 0; c < 3; ++c) {
        light.color[int(c)] = 0.5f * (before[0][c].at(x, y) + before[1][c].at(x, y));
        for (std::size_t h = 0; h < 2; ++h) halves[h][c].row(y)[x] = before[h][c].at(as.x, as.y);
      }
      variance.row(y)[x] = std::min(variance.at(x, y), variance.at(as.x, as.y));
    }
  variance.extend();
  for (Color& half : halves)
    for (Plane& plane : half) plane.extend();
  return lights;
}

void dim_fireflies(std::array<Color, 2>& halves, Plane& variance) {
  for (int pass = 0; pass < dimming_passes; ++pass) dim_once(halves, variance);
}

}  // namespace meristem::denoise
