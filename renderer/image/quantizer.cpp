#include "renderer/image/quantizer.h"

#include "geometry/base/key.h"

#include <algorithm>

namespace meristem {

namespace {

// Triangular in (-1, 1): the difference of two of four numbers that the four pixels of a square share in a ring.
float chance(int x, int y, int channel) {
  const Key ring = hash_keys(Key(x / 2), Key(y / 2), Key(channel));
  const int corner = y % 2 ? 3 - x % 2 : x % 2;
  auto number = [&](int i) { return int(ring >> 16 * (i % 4) & 0xffff); };
  return float(number(corner) - number(corner + 1)) * 0x1p-16f;
}

// The share of the triangle's area below `at`: uniform in (0, 1) if that is triangular.
float uniform_of(float at) { return at < 0 ? 0.5f * (1 + at) * (1 + at) : 1 - 0.5f * (1 - at) * (1 - at); }

}  // namespace

std::uint32_t Quantizer::step(float value, int x, int y, int channel) const {
  if (!(value > 0)) return 0;
  const float end = float(last_), exact = std::min(value, 1.0f) * end;
  if (!dithers_) return std::uint32_t(exact + 0.5f);
  const float at = chance(x0_ + x, y0_ + y, channel);
  const bool at_an_end = exact < 0.5f || exact > end - 0.5f;
  return std::min(std::uint32_t(exact + (at_an_end ? uniform_of(at) : 0.5f + at)), last_);
}

}  // namespace meristem
