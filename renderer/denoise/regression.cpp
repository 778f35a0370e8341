#include "renderer/denoise/regression.h"

#include "renderer/denoise/vector_clones.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace meristem::denoise {

namespace {

constexpr int lanes = 8;  // pixels side by side
constexpr int unknowns = 1 + feature_count;
constexpr int matrix_size = unknowns * (unknowns + 1) / 2;
static_assert(tile_width % lanes == 0);

typedef float Lanes __attribute__((vector_size(lanes * sizeof(float))));

// The normal equations of one half of `lanes` pixels: the lower triangle of the matrix by rows, and the right sides.
struct Equations {
  Lanes matrix[matrix_size], right[3][unknowns];
};

// Pointers to the first of `lanes` neighbouring pixels.
struct Strip {
  const float* features[feature_count];
  const float* colors[2][3];
  std::ptrdiff_t stride;  // from row to row, of all of them
  const float* weights[2];
};

// Of weights, which are not negative: half of the pixels of a window are often of no use to any lane.
inline bool all_zero(const float* weights) {
  std::uint64_t bits[lanes / 2];
  std::memcpy(bits, weights, sizeof bits);
  return (bits[0] | bits[1] | bits[2] | bits[3]) == 0;
}

VECTOR_CLONES void sum_up(const Strip& strip, Equations* equations) {
  const auto load = [](const float* from, Lanes& to) { std::memcpy(&to, from, sizeof to); };
  std::memset(equations, 0, 2 * sizeof *equations);
  Lanes middle[feature_count];
  for (int f = 0; f < feature_count; ++f) load(strip.features[f], middle[f]);
  const float* weights[2] = {strip.weights[0], strip.weights[1]};
  for (int dy = -window_radius; dy <= window_radius; ++dy)
    for (int dx = -window_radius; dx <= window_radius;
         ++dx, weights[0] += tile_width * tile_height, weights[1] += tile_width * tile_height) {
      if (all_zero(weights[0]) && all_zero(weights[1])) continue;
      const std::ptrdiff_t at = dy * strip.stride + dx;
      Lanes x[unknowns];
      x[0] = Lanes{} + 1;
      for (int f = 0; f < feature_count; ++f) {
        Lanes value;
        load(strip.features[f] + at, value);
        x[1 + f] = value - middle[f];
      }
      for (int h = 0; h < 2; ++h) {
        Equations& e = equations[h];
        Lanes weight, color[3];
        load(weights[h], weight);
        for (int c = 0; c < 3; ++c) load(strip.colors[h][c] + at, color[c]);
        int m = 0;
        for (int i = 0; i < unknowns; ++i) {
          const Lanes weighted = weight * x[i];
          for (int j = 0; j <= i; ++j) e.matrix[m++] += weighted * x[j];
          for (int c = 0; c < 3; ++c) e.right[c][i] += weighted * color[c];
        }
      }
    }
}

// A colour of which a channel is this many times the mean of those it was fitted to, or one part in so many, is no fit
// but an extrapolation: of light that one path in hundreds brings, over features that hardly vary.
constexpr float trusted_factor = 8;

bool trusted(float fitted, float mean) { return fitted * trusted_factor >= mean && fitted <= trusted_factor * mean; }

// Solves the equations of one lane by Cholesky's decomposition for the first unknown of each right side: the colour in
// the middle. In turned order it is the last, the one that forward substitution gives without going back.
std::array<float, 3> value_in_the_middle(const Equations& e, int lane, float stiffness) {
  double l[unknowns][unknowns];
  const auto turned = [](int i) { return unknowns - 1 - i; };
  const auto entry = [&](int i, int j) {  // i >= j, in turned order
    const int a = turned(j), b = turned(i);
    return double(e.matrix[a * (a + 1) / 2 + b][lane]);
  };
  const double sum = entry(unknowns - 1, unknowns - 1);
  for (int i = 0; i < unknowns; ++i)
    for (int j = 0; j <= i; ++j) {
      double v = entry(i, j);
      if (i == j && i < unknowns - 1) v += double(stiffness) + 1e-6 * sum;
      for (int k = 0; k < j; ++k) v -= l[i][k] * l[j][k];
      l[i][j] = i == j ? std::sqrt(std::max(v, 1e-12 * sum)) : v / l[j][j];
    }
  std::array<float, 3> fitted, mean;
  bool all_trusted = true;
  for (std::size_t c = 0; c < 3; ++c) {
    double y[unknowns];
    for (int i = 0; i < unknowns; ++i) {
      y[i] = double(e.right[c][turned(i)][lane]);
      for (int k = 0; k < i; ++k) y[i] -= l[i][k] * y[k];
      y[i] /= l[i][i];
    }
    fitted[c] = float(y[unknowns - 1] / l[unknowns - 1][unknowns - 1]);
    mean[c] = sum > 0 ? float(double(e.right[c][0][lane]) / sum) : fitted[c];
    all_trusted = all_trusted && trusted(fitted[c], mean[c]);
  }
  return all_trusted ? fitted : mean;
}

}  // namespace

void fit_tile(const std::array<Color, 2>& halves, const Features& features, const Plane& stiffness, const Tile& tile,
              const std::array<const float*, 2>& weights, std::array<Color, 2>& out) {
  const int width = stiffness.width(), y1 = std::min(tile.y0 + tile_height, stiffness.height());
  for (int y = tile.y0; y < y1; ++y)
    for (int x = tile.x0; x < std::min(tile.x0 + tile_width, width); x += lanes) {
      Strip strip;
      for (std::size_t f = 0; f < feature_count; ++f) strip.features[f] = features[f].row(y) + x;
      strip.stride = features[0].row(1) - features[0].row(0);
      for (std::size_t h = 0; h < 2; ++h) {
        for (std::size_t c = 0; c < 3; ++c) strip.colors[h][c] = halves[h][c].row(y) + x;
        strip.weights[h] = weights[1 - h] + (y - tile.y0) * tile_width + (x - tile.x0);
      }
      Equations equations[2];
      sum_up(strip, equations);
      for (int lane = 0; lane < std::min(lanes, width - x); ++lane)
        for (std::size_t h = 0; h < 2; ++h) {
          const auto color = value_in_the_middle(equations[h], lane, stiffness.at(x + lane, y));
          for (std::size_t c = 0; c < 3; ++c) out[h][c].row(y)[x + lane] = std::max(color[c], 0.0f);
        }
    }
}

}  // namespace meristem::denoise
