#include "renderer/lights/panorama.h"

#include "renderer/scene/warps.h"

namespace meristem {
namespace {

// Which texels of `from` one texel of `to` covers, in one direction, and how much of each: at most three, since the
// sides are halved and rounded up.
struct Cover {
  int first;
  float parts[3] = {0, 0, 0};
  Cover(int i, int from, int to) {
    const float ratio = float(from) / float(to), begin = float(i) * ratio, end = begin + ratio;
    first = int(begin);
    for (int k = 0; k < 3; ++k)
      parts[k] = std::max(0.f, std::min(end, float(first + k + 1)) - std::max(begin, float(first + k)));
  }
};

}  // namespace

Panorama::Panorama(std::vector<Spectrum> texels, int width, int height) {
  levels_.push_back({width, height, std::move(texels)});
  while (levels_.back().width > 1 || levels_.back().height > 1) levels_.push_back(levels_.back().halved());
}

Spectrum Panorama::Level::texel(int x, int y) const {
  x = (x % width + width) % width;
  y = std::clamp(y, 0, height - 1);
  return texels[std::size_t(y) * std::size_t(width) + std::size_t(x)];
}

Spectrum Panorama::Level::at(Vec2f place) const {
  const float fx = place.x * float(width) - 0.5f, fy = place.y * float(height) - 0.5f;
  const int x = int(std::floor(fx)), y = int(std::floor(fy));
  const float tx = fx - float(x), ty = fy - float(y);
  return lerp(lerp(texel(x, y), texel(x + 1, y), tx), lerp(texel(x, y + 1), texel(x + 1, y + 1), tx), ty);
}

Panorama::Level Panorama::Level::halved() const {
  Level half{(width + 1) / 2, (height + 1) / 2, {}};
  half.texels.reserve(std::size_t(half.width) * std::size_t(half.height));
  for (int y = 0; y < half.height; ++y) {
    const Cover rows(y, height, half.height);
    for (int x = 0; x < half.width; ++x) {
      const Cover columns(x, width, half.width);
      Spectrum sum;
      float whole = 0;
      for (int k = 0; k < 9; ++k) {
        const int row = std::min(rows.first + k / 3, height - 1);
        const float sine = std::sin(pi_f * (float(row) + 0.5f) / float(height));
        const float weight = rows.parts[k / 3] * columns.parts[k % 3] * sine;
        if (weight > 0) sum += texel(columns.first + k % 3, row) * weight;
        whole += weight;
      }
      half.texels.push_back(sum / whole);
    }
  }
  return half;
}

// As high as the level's lookups are; side by side as wide as the cone.
Spectrum Panorama::mean_across(const Level& level, Vec2f place, float angle) {
  constexpr int most = 32;
  const float sine = std::max(std::sin(pi_f * place.y), 0.5f * angle);
  const float width = std::min(1.f, angle / (2 * pi_f * sine));
  const int count = std::clamp(int(std::ceil(width * float(level.width))), 1, most);
  Spectrum sum;
  for (int i = 0; i < count; ++i)
    sum += level.at({place.x + width * ((float(i) + 0.5f) / float(count) - 0.5f), place.y});
  return sum / float(count);
}

// Bilinear between means over boxes of n texels deviates by n / 2 texels, an even mean over m texels by m / sqrt(12).
Spectrum Panorama::mean(Vec2f place, float angle) const {
  constexpr float alike = 0.57735f;
  const float texels = alike * angle / pi_f * float(height());
  if (!(texels > 1)) return at(place);
  const float exact = std::min(std::log2(texels), float(levels_.size() - 1));
  const auto finer = std::min(std::size_t(exact), levels_.size() - 1),
             coarser = std::min(finer + 1, levels_.size() - 1);
  return lerp(mean_across(levels_[finer], place, angle), mean_across(levels_[coarser], place, angle),
              exact - float(finer));
}

}  // namespace meristem
