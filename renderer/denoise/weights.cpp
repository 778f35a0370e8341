#include "renderer/denoise/weights.h"

#include "renderer/denoise/vector_clones.h"

#include <algorithm>

namespace meristem::denoise {

namespace {

constexpr int padded_width = tile_width + 2 * patch_radius, padded_height = tile_height + 2 * patch_radius;
constexpr float least_variance = 1e-10f;

// Where a tile of full size would leave the rows of the planes, its last row is repeated.
int inside(int y, int height) { return std::min(y, height + Plane::border - 1); }

// Distances of the pixels of a row of the tile and its surroundings to those that lie (dx, dy) from them.
VECTOR_CLONES void pixel_distances(const Guide& guide, int x0, int y, int dx, int dy, float k2, float* out) {
  const int height = guide.color[0].height();
  const int yp = inside(y, height), yq = inside(y + dy, height);
  float difference[padded_width] = {}, scale[padded_width] = {};
  for (int c = 0; c < 3; ++c) {
    const float* const cp = guide.color[std::size_t(c)].row(yp) + x0;
    const float* const cq = guide.color[std::size_t(c)].row(yq) + x0 + dx;
    const float* const vp = guide.variance[std::size_t(c)].row(yp) + x0;
    const float* const vq = guide.variance[std::size_t(c)].row(yq) + x0 + dx;
    for (int x = 0; x < padded_width; ++x) {
      const float d = cp[x] - cq[x];
      difference[x] += d * d - (vp[x] + std::min(vp[x], vq[x]));
      scale[x] += vp[x] + vq[x];
    }
  }
  for (int x = 0; x < padded_width; ++x) out[x] = difference[x] / (k2 * scale[x] + least_variance);
}

// Sums of 2 patch_radius + 1 neighbours.
VECTOR_CLONES void sum_along(const float* in, float* out) {
  for (int x = 0; x < tile_width; ++x) {
    float sum = in[x];
    for (int i = 1; i <= 2 * patch_radius; ++i) sum += in[x + i];
    out[x] = sum;
  }
}

// From sums of rows to weights: exp(-d) but for d > 1.5, where this is less, and 0 from 4 on.
VECTOR_CLONES void weigh(const float (*rows)[tile_width], float* out) {
  constexpr float patch = (2 * patch_radius + 1) * (2 * patch_radius + 1);
  for (int x = 0; x < tile_width; ++x) {
    float sum = rows[0][x];
    for (int i = 1; i <= 2 * patch_radius; ++i) sum += rows[i][x];
    const float t = std::clamp(1 - sum * (0.25f / patch), 0.0f, 1.0f);
    out[x] = t * t * t * t;
  }
}

void clear_outside(const Plane& plane, const Tile& tile, int dx, int dy, float* weights) {
  for (int y = 0; y < tile_height; ++y) {
    float* const row = weights + y * tile_width;
    const int qy = tile.y0 + y + dy;
    if (qy < 0 || qy >= plane.height()) std::fill_n(row, tile_width, 0.0f);
    const int first = std::clamp(-(tile.x0 + dx), 0, tile_width);
    const int end = std::clamp(plane.width() - (tile.x0 + dx), 0, tile_width);
    std::fill(row, row + first, 0.0f);
    std::fill(row + end, row + tile_width, 0.0f);
  }
}

}  // namespace

void find_weights(const Guide& guide, const Tile& tile, float strictness, float* out) {
  const float k2 = strictness * strictness;
  for (int dy = -window_radius; dy <= window_radius; ++dy)
    for (int dx = -window_radius; dx <= window_radius; ++dx, out += tile_width * tile_height) {
      float sums[padded_height][tile_width];
      for (int y = 0; y < padded_height; ++y) {
        float distances[padded_width];
        pixel_distances(guide, tile.x0 - patch_radius, tile.y0 + y - patch_radius, dx, dy, k2, distances);
        sum_along(distances, sums[y]);
      }
      for (int y = 0; y < tile_height; ++y) weigh(sums + y, out + y * tile_width);
      clear_outside(guide.color[0], tile, dx, dy, out);
    }
}

}  // namespace meristem::denoise
