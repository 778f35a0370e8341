// Film: what the samples of each pixel sum up to. Pixels are independent and each takes its samples in their order, so
// the image has the same bits for any number of threads, size of tiles and division into passes.
//
// Samples that are not finite are dropped and counted. Different pixels may be added to by different threads;
// everything else needs the threads to be joined. 40 bytes a pixel.
#pragma once

#include "renderer/image/image.h"
#include "renderer/scene/interfaces.h"

#include <cstdint>
#include <vector>

namespace meristem {

// A rectangle of pixels of the full frame: [x0, x1) x [y0, y1).
struct PixelWindow {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool empty() const { return x1 <= x0 || y1 <= y0; }
  PixelWindow intersected(const PixelWindow& w) const;
  bool operator==(const PixelWindow&) const = default;
};

class Film {
 public:
  // `mean_weight` of the samples to come: FilterSampler::mean_weight().
  Film(PixelWindow window, float mean_weight);

  const PixelWindow& window() const { return window_; }

  // Adds one sample to the pixel (x, y) of the full frame, which lies in the window; `covered` if the camera ray met a
  // surface.
  void add(int x, int y, Spectrum radiance, bool covered, float weight);

  std::uint32_t samples(int x, int y) const { return pixel(x, y).samples; }
  std::uint64_t total_samples() const;      // taken, the dropped ones among them
  std::uint64_t nonfinite_samples() const;  // dropped
  std::uint64_t pixels_without_samples() const;

  // The image so far: RGBA, scene-linear Rec.709, alpha is the coverage. A pixel without samples is zero.
  Image develop() const;

 private:
  struct Pixel {
    double sum[3] = {0, 0, 0};  // of weighted radiance
    float weight = 0;
    float covered = 0;  // of weights
    std::uint32_t samples = 0;
    std::uint32_t nonfinite = 0;
  };

  std::size_t index(int x, int y) const {
    return std::size_t(y - window_.y0) * std::size_t(window_.width()) + std::size_t(x - window_.x0);
  }
  const Pixel& pixel(int x, int y) const { return pixels_[index(x, y)]; }

  PixelWindow window_;
  float mean_weight_;
  std::vector<Pixel> pixels_;
};

}  // namespace meristem
