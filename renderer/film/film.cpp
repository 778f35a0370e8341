#include "renderer/film/film.h"

#include "geometry/base/check.h"

#include <algorithm>

namespace meristem {

PixelWindow PixelWindow::intersected(const PixelWindow& w) const {
  return {std::max(x0, w.x0), std::max(y0, w.y0), std::min(x1, w.x1), std::min(y1, w.y1)};
}

Film::Film(PixelWindow window, float mean_weight) : window_(window), mean_weight_(mean_weight) {
  CHECK(!window.empty(), "a film from ({}, {}) to ({}, {})", window.x0, window.y0, window.x1, window.y1);
  pixels_.resize(std::size_t(window.width()) * std::size_t(window.height()));
}

void Film::add(int x, int y, Spectrum radiance, bool covered, float weight) {
  Pixel& p = pixels_[index(x, y)];
  ++p.samples;
  if (!is_finite(radiance)) {
    ++p.nonfinite;
    return;
  }
  for (int c = 0; c < 3; ++c) p.sum[c] += double(weight) * double(radiance[c]);
  p.weight += weight;
  if (covered) p.covered += weight;
}

std::uint64_t Film::total_samples() const {
  std::uint64_t total = 0;
  for (const Pixel& p : pixels_) total += p.samples;
  return total;
}

std::uint64_t Film::nonfinite_samples() const {
  std::uint64_t total = 0;
  for (const Pixel& p : pixels_) total += p.nonfinite;
  return total;
}

std::uint64_t Film::pixels_without_samples() const {
  return std::uint64_t(std::ranges::count_if(pixels_, [](const Pixel& p) { return p.samples == 0; }));
}

Image Film::develop() const {
  Image image{window_.width(), window_.height(), 4, {}};
  image.pixels.reserve(pixels_.size() * 4);
  for (const Pixel& p : pixels_) {
    // Dividing by the sum of the weights makes a constant image exact. With negative lobes a few samples may nearly
    // cancel; half of the expected sum then bounds the pixel, and stops mattering as samples come in.
    const float finite = float(p.samples - p.nonfinite);
    const double divisor = double(std::max(p.weight, 0.5f * mean_weight_ * finite));
    for (double sum : p.sum) image.pixels.push_back(divisor > 0 ? float(sum / divisor) : 0.0f);
    image.pixels.push_back(divisor > 0 ? float(std::clamp(double(p.covered) / divisor, 0.0, 1.0)) : 0.0f);
  }
  return image;
}

}  // namespace meristem
