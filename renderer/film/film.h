// Film: what the samples of each pixel sum up to, and what it shows: AOVs and mattes, those asked for.
//
// A pixel's state does not depend on the order of its samples, nor on how they are divided among passes, threads,
// processes or films that are merged later: sums are exact (exact_sum.h), weights are whole numbers, and of the nearest
// samples the one with the smaller number wins. Only costs, which are measured, differ from run to run.
//
// Samples that are not finite, or brighter than ExactSum can hold (4e12), are dropped and counted. Different pixels may
// be added to by different threads; everything else needs the threads to be joined. 64 bytes a pixel, AOVs take more:
// variance 16, the second half 64, albedo and normal together 48, those of the nearest sample together 48, costs 16, a
// matte at least 24.
#pragma once

#include "renderer/film/exact_sum.h"
#include "renderer/film/matte.h"
#include "renderer/film/pixel_window.h"
#include "renderer/film/zeroed_vector.h"
#include "renderer/image/image.h"
#include "renderer/scene/aov.h"
#include "renderer/scene/interfaces.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace meristem {

// One sample of a pixel.
struct FilmSample {
  Spectrum radiance = {};
  bool covered = true;  // the camera ray met a surface
  int weight = 1;       // +1 or -1
  std::uint32_t number = 0;
  const FirstSurface* first = nullptr;  // if AOVs or mattes are wanted
  float depth = 0;                      // of the first surface, along the view axis
  Vec2f motion = {};                    // of it on the film, in pixels a frame
  std::uint64_t nanoseconds = 0;        // that it took, and what it expanded
  ThreadExpansions expansions = {};
};

class Film {
 public:
  // `mean_weight` of the samples to come: FilterSampler::mean_weight(). `aovs` as in RenderSettings.
  Film(PixelWindow window, float mean_weight, std::vector<Aov> aovs = {});

  static constexpr std::size_t least_bytes_a_pixel = 64;

  const PixelWindow& window() const { return window_; }
  float mean_weight() const { return mean_weight_; }
  const std::vector<Aov>& aovs() const { return aovs_; }

  // What samples need to bring along.
  bool wants_first_surface() const { return !surfaces_.empty() || !nearest_.empty() || wants_mattes(); }
  bool wants_costs() const { return !costs_.empty(); }

  // Adds one sample to the pixel (x, y) of the full frame, which lies in the window.
  void add(int x, int y, const FilmSample& sample);
  // Adds the samples of another film with the same window and AOVs.
  void merge(const Film& other);

  std::uint32_t samples(int x, int y) const { return pixel(x, y).samples; }
  std::uint64_t total_samples() const;      // taken, the dropped ones among them
  std::uint64_t nonfinite_samples() const;  // dropped
  std::uint64_t pixels_without_samples() const;

  // Of the samples of a pixel: needs the AOV variance.
  struct Statistics {
    double samples = 0, mean = 0, variance = 0;  // of luminance; variance of one sample, 0 for fewer than two
  };
  Statistics statistics(int x, int y) const;

  // The means of two independent halves of a pixel's samples, four by four in turn: needs the AOV second_half. A half
  // without samples is the mean of all.
  std::array<Spectrum, 2> halves(int x, int y) const;

  // The image so far: RGBA, scene-linear Rec.709, alpha is the coverage. A pixel without samples is zero.
  Image develop() const;
  // An AOV of aovs(), not a matte: its channels as aov.h names them. A pixel without samples is zero.
  Image develop(Aov aov) const;
  // The matte of an AOV of aovs(), `layers` of two ranks each: 4 * layers channels (cryptomatte.h); `hashes` of the
  // names by number.
  Image develop_matte(Aov aov, const std::vector<std::uint32_t>& hashes, int layers) const;
  // The same of rows from `begin` up to `end` of the window alone. Any thread, while nothing is added.
  void develop(int begin, int end, float* values) const;
  void develop(Aov aov, int begin, int end, float* values) const;
  void develop_matte(Aov aov, const std::vector<std::uint32_t>& hashes, int layers, int begin, int end,
                     float* values) const;

 private:
  friend class FilmStorage;  // of film files

  struct Pixel {
    ExactSum sum[3];  // of weighted radiance
    std::int32_t weight = 0;
    std::int32_t covered = 0;  // of weights
    std::uint32_t samples = 0;
    std::uint32_t nonfinite = 0;
  };
  // Weighted sums of the first surfaces, in units of 2^-40: 2^20 terms up to 4 fit.
  struct Surfaces {
    std::int64_t albedo[3] = {0, 0, 0}, normal[3] = {0, 0, 0};
  };
  struct Half {
    ExactSum sum[3];
    std::int32_t weight = 0;
    std::uint32_t samples = 0;  // the finite ones
    void add(const Half& o);
  };
  struct Nearest {
    float depth, position[3], u, v, motion[2];
    std::int32_t object, material, level;
    std::uint32_t sample;
  };
  struct Cost {
    std::uint64_t nanoseconds = 0;
    std::uint32_t expanded = 0, reexpanded = 0;
  };
  static constexpr std::size_t matte_count = 3;

  bool has(Aov aov) const;
  bool wants_mattes() const;
  std::size_t index(int x, int y) const {
    return std::size_t(y - window_.y0) * std::size_t(window_.width()) + std::size_t(x - window_.x0);
  }
  const Pixel& pixel(int x, int y) const { return pixels_[index(x, y)]; }
  std::span<const Pixel> rows(int begin, int end) const {
    const auto width = std::size_t(window_.width());
    return std::span(pixels_).subspan(std::size_t(begin) * width, std::size_t(end - begin) * width);
  }
  double divisor(const Pixel& p) const;
  double divisor(std::int32_t weight, std::uint32_t finite_samples) const;
  void add_first_surface(std::size_t i, const FilmSample& sample);
  void add_to_mattes(std::size_t i, const FilmSample& sample);
  void develop_pixel(Aov aov, std::size_t i, float* out) const;

  PixelWindow window_;
  float mean_weight_;
  std::vector<Aov> aovs_;
  ZeroedVector<Pixel> pixels_;
  // Empty if not wanted
  ZeroedVector<ExactSum> squares_;  // of luminance
  ZeroedVector<Half> second_halves_;
  ZeroedVector<Surfaces> surfaces_;
  ZeroedVector<Nearest> nearest_;
  ZeroedVector<Cost> costs_;
  std::array<Matte, matte_count> mattes_;  // of objects, materials, productions
};

}  // namespace meristem
