#include "renderer/report/flip.h"

#include "geometry/base/srgb.h"
#include "geometry/base/vec.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <stdexcept>

namespace meristem {

namespace {

// Section 4.1.2 and 4.3: exponents and end points of the map from colour distances to errors.
constexpr double color_exponent = 0.7, color_split = 0.4, color_split_error = 0.95, feature_exponent = 0.5;
constexpr double feature_width_degrees = 0.082;  // section 4.2

const Vec3d white{0.950428545, 1, 1.088900371};  // D65

Vec3d xyz_of(Vec3d c) {
  return {0.4123866 * c.x + 0.3575915 * c.y + 0.1804505 * c.z, 0.2126368 * c.x + 0.7151830 * c.y + 0.0721802 * c.z,
          0.0193306 * c.x + 0.1191972 * c.y + 0.9503726 * c.z};
}
Vec3d rgb_of(Vec3d c) {
  return {3.2410033 * c.x - 1.5373990 * c.y - 0.4986159 * c.z, -0.9692243 * c.x + 1.8759300 * c.y + 0.0415542 * c.z,
          0.0556394 * c.x - 0.2040112 * c.y + 1.0571490 * c.z};
}

// The opponent space in which contrast sensitivity is applied, linear in light.
Vec3d ycxcz_of(Vec3d rgb) {
  const Vec3d c = xyz_of(rgb) / white;
  return {116 * c.y - 16, 500 * (c.x - c.y), 200 * (c.y - c.z)};
}
Vec3d rgb_of_ycxcz(Vec3d c) {
  const double y = (c.x + 16) / 116;
  return rgb_of(Vec3d{y + c.y / 500, y, y - c.z / 200} * white);
}

double lab_curve(double t) {
  constexpr double delta = 6.0 / 29;
  return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
}
// CIELAB with the chroma of dark colours taken back (the Hunt effect).
Vec3d hunt_lab_of(Vec3d rgb) {
  const Vec3d c = xyz_of(rgb) / white;
  const double x = lab_curve(c.x), y = lab_curve(c.y), z = lab_curve(c.z), lightness = 116 * y - 16;
  return {lightness, 0.01 * lightness * 500 * (x - y), 0.01 * lightness * 200 * (y - z)};
}

double hyab(Vec3d a, Vec3d b) { return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z); }

template <class T>
struct Grid {
  int width, height;
  std::vector<T> values;
  Grid(int w, int h) : width(w), height(h), values(std::size_t(w) * std::size_t(h)) {}
  // The nearest pixel's, outside.
  const T& at(int x, int y) const {
    return values[std::size_t(std::clamp(y, 0, height - 1)) * std::size_t(width) +
                  std::size_t(std::clamp(x, 0, width - 1))];
  }
};

// A filter along one axis, from -radius to radius.
using Kernel = std::vector<double>;

Kernel make_kernel(int radius, const std::function<double(int)>& value) {
  Kernel kernel;
  for (int i = -radius; i <= radius; ++i) kernel.push_back(value(i));
  return kernel;
}

// Along x for step (1, 0), along y for (0, 1). `weight(i)` may be a number or a vector of one number a channel.
template <class T, class Weight>
Grid<T> filtered(const Grid<T>& in, int step_x, int step_y, const std::vector<Weight>& kernel) {
  Grid<T> out(in.width, in.height);
  const int radius = int(kernel.size() / 2);
  for (int y = 0; y < in.height; ++y)
    for (int x = 0; x < in.width; ++x) {
      T sum{};
      for (int i = -radius; i <= radius; ++i)
        sum = sum + in.at(x + i * step_x, y + i * step_y) * kernel[std::size_t(i + radius)];
      out.values[std::size_t(y) * std::size_t(in.width) + std::size_t(x)] = sum;
    }
  return out;
}

// A term a * sqrt(pi / b) * exp(-pi^2 d^2 / b) of the contrast sensitivity functions, d in degrees (table 1).
struct SensitivityTerm {
  Vec3d amplitude, width;  // of the channels: achromatic, red-green, blue-yellow
};
const SensitivityTerm sensitivity[2] = {{{1, 1, 34.1}, {0.0047, 0.0053, 0.04}}, {{0, 0, 13.5}, {1e-5, 1e-5, 0.025}}};

struct Sensitivity {
  explicit Sensitivity(double pixels_per_degree) {
    const int radius = int(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * pixels_per_degree));
    Vec3d total{};
    for (int term = 0; term < 2; ++term) {
      Vec3d sum{};
      for (int i = -radius; i <= radius; ++i) {
        const double d = i / pixels_per_degree;
        Vec3d w;
        for (int c = 0; c < 3; ++c) w[c] = std::exp(-pi * pi * d * d / sensitivity[term].width[c]);
        kernels[term].push_back(w);
        sum = sum + w;
      }
      for (int c = 0; c < 3; ++c) {
        amplitude[term][c] = sensitivity[term].amplitude[c] * std::sqrt(pi / sensitivity[term].width[c]);
        total[c] += amplitude[term][c] * sum[c] * sum[c];
      }
    }
    for (Vec3d& a : amplitude) a = a / total;  // the filter keeps the mean
  }

  // Each term is separable, their sum is not.
  Grid<Vec3d> filter(const Grid<Vec3d>& in) const {
    Grid<Vec3d> result(in.width, in.height);
    for (int term = 0; term < 2; ++term) {
      const Grid<Vec3d> part = filtered(filtered(in, 1, 0, kernels[term]), 0, 1, kernels[term]);
      for (std::size_t i = 0; i < result.values.size(); ++i)
        result.values[i] = result.values[i] + part.values[i] * amplitude[term];
    }
    return result;
  }

  std::vector<Vec3d> kernels[2];
  Vec3d amplitude[2];
};

Grid<Vec3d> opponent_colors(const Image& image) {
  Grid<Vec3d> out(image.width, image.height);
  for (std::size_t i = 0; i < out.values.size(); ++i) {
    Vec3d c;
    for (int k = 0; k < 3; ++k) {
      const float v = image.pixels[i * std::size_t(image.channels) + std::size_t(k)];
      c[k] = linear_of_srgb(v > 0 ? std::min(double(v), 1.0) : 0.0);
    }
    out.values[i] = ycxcz_of(c);
  }
  return out;
}

// Colours as the eye resolves them, in the space where their distance is measured.
Grid<Vec3d> perceived_colors(const Grid<Vec3d>& opponent, const Sensitivity& eye) {
  Grid<Vec3d> out = eye.filter(opponent);
  for (Vec3d& c : out.values) {
    c = rgb_of_ycxcz(c);
    for (int k = 0; k < 3; ++k) c[k] = std::clamp(c[k], 0.0, 1.0);
    c = hunt_lab_of(c);
  }
  return out;
}

// Its positive values sum to 1, its negative ones to -1.
Kernel balanced(Kernel kernel) {
  double positive = 0, negative = 0;
  for (const double w : kernel) (w > 0 ? positive : negative) += std::abs(w);
  for (double& w : kernel) w /= w > 0 ? positive : negative;
  return kernel;
}

struct Features {
  Grid<double> edges, points;
};

// Sizes of edges and points: first and second derivatives of a Gaussian over the achromatic channel.
class FeatureDetector {
 public:
  explicit FeatureDetector(double pixels_per_degree) {
    const double deviation = 0.5 * feature_width_degrees * pixels_per_degree;
    const int radius = int(std::ceil(3 * deviation));
    const auto gaussian = [=](int x) { return std::exp(-x * x / (2 * deviation * deviation)); };
    smooth_ = make_kernel(radius, gaussian);
    const double sum = std::accumulate(smooth_.begin(), smooth_.end(), 0.0);
    for (double& w : smooth_) w /= sum;
    edge_ = balanced(make_kernel(radius, [=](int x) { return -x * gaussian(x); }));
    point_ = balanced(
        make_kernel(radius, [=](int x) { return (double(x) * x / (deviation * deviation) - 1) * gaussian(x); }));
  }

  Features detect(const Grid<Vec3d>& opponent) const {
    Grid<double> lightness(opponent.width, opponent.height);
    for (std::size_t i = 0; i < lightness.values.size(); ++i) lightness.values[i] = (opponent.values[i].x + 16) / 116;
    return {sizes(lightness, edge_), sizes(lightness, point_)};
  }

 private:
  Grid<double> sizes(const Grid<double>& in, const Kernel& derivative) const {
    Grid<double> x = filtered(filtered(in, 1, 0, derivative), 0, 1, smooth_);
    const Grid<double> y = filtered(filtered(in, 0, 1, derivative), 1, 0, smooth_);
    for (std::size_t i = 0; i < x.values.size(); ++i) x.values[i] = std::hypot(x.values[i], y.values[i]);
    return x;
  }

  Kernel smooth_, edge_, point_;
};

double color_error(double distance, double largest) {
  const double d = std::pow(distance, color_exponent), split = color_split * largest;
  if (d < split) return color_split_error / split * d;
  return color_split_error + (d - split) / (largest - split) * (1 - color_split_error);
}

}  // namespace

Image flip(const Image& reference, const Image& test, const FlipOptions& options) {
  if (reference.width != test.width || reference.height != test.height ||
      std::min(reference.channels, test.channels) < 3)
    throw std::invalid_argument(fmt::format("images of {} x {} x {} and {} x {} x {} cannot be flipped",
                                            reference.width, reference.height, reference.channels, test.width,
                                            test.height, test.channels));
  const Sensitivity eye(double(options.pixels_per_degree));
  const FeatureDetector detector(double(options.pixels_per_degree));
  const Grid<Vec3d> a = opponent_colors(reference), b = opponent_colors(test);
  const Grid<Vec3d> colors_a = perceived_colors(a, eye), colors_b = perceived_colors(b, eye);
  const Features features_a = detector.detect(a), features_b = detector.detect(b);
  const double largest = std::pow(hyab(hunt_lab_of({0, 1, 0}), hunt_lab_of({0, 0, 1})), color_exponent);

  Image result{reference.width, reference.height, 1, std::vector<float>(a.values.size())};
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    const double color = color_error(hyab(colors_a.values[i], colors_b.values[i]), largest);
    const double feature = std::max(std::abs(features_a.edges.values[i] - features_b.edges.values[i]),
                                    std::abs(features_a.points.values[i] - features_b.points.values[i]));
    const double feature_error = std::pow(std::min(1.0, feature / std::sqrt(2.0)), feature_exponent);
    result.pixels[i] = float(std::clamp(std::pow(color, 1 - feature_error), 0.0, 1.0));
  }
  return result;
}

double mean_value(const Image& image) {
  if (image.pixels.empty()) return 0;
  return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0) / double(image.pixels.size());
}

}  // namespace meristem
