#include "renderer/film/noise.h"

#include <cmath>

namespace meristem::noise {

namespace {

// Where light is weak, less of it is seen than the square root says.
constexpr double floor_of_root = 1e-4;

// The means of the neighbours' luminance and of their variances, the pixel itself left out.
bool is_quiet(const Film& film, const std::vector<Film::Statistics>& pixels, int x, int y, double samples,
              double limit) {
  const PixelWindow& w = film.window();
  const PixelWindow around = PixelWindow{x - radius, y - radius, x + radius + 1, y + radius + 1}.intersected(w);
  double light = 0, variance = 0;
  int count = -1;  // itself
  for (int j = around.y0; j < around.y1; ++j)
    for (int i = around.x0; i < around.x1; ++i, ++count) {
      if (i == x && j == y) continue;
      const Film::Statistics& s = pixels[std::size_t(j - w.y0) * std::size_t(w.width()) + std::size_t(i - w.x0)];
      light += s.mean;
      variance += s.variance;
    }
  if (count == 0) return false;
  const double error = std::sqrt(variance / count / samples);
  return error <= limit * (std::sqrt(std::max(light / count, 0.0)) + floor_of_root);
}

}  // namespace

void choose_finished(const Film& film, std::uint32_t samples, double limit, AdaptiveState& state) {
  const PixelWindow& w = film.window();
  std::vector<Film::Statistics> pixels;
  pixels.reserve(std::size_t(w.width()) * std::size_t(w.height()));
  for (int y = w.y0; y < w.y1; ++y)
    for (int x = w.x0; x < w.x1; ++x) pixels.push_back(film.statistics(x, y));
  state.finished.resize(pixels.size());
  std::size_t i = 0;
  for (int y = w.y0; y < w.y1; ++y)
    for (int x = w.x0; x < w.x1; ++x, ++i)
      if (!state.finished[i]) state.finished[i] = is_quiet(film, pixels, x, y, double(samples), limit);
  state.decided_at = samples;
}

}  // namespace meristem::noise
