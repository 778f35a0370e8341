// RandomStream: as many random numbers as it takes, for what draws an unknown number of them, such as steps through a
// medium. The first is the number it starts from, which keeps the sampler's even spread; the others are hashes of it.
#pragma once

#include "geometry/base/key.h"

#include <bit>
#include <cstdint>

namespace meristem {

class RandomStream {
 public:
  explicit RandomStream(float first) : first_(first) {}
  // In [0, 1).
  float next() {
    const std::uint64_t index = count_++;
    return index == 0 ? first_ : uniform_float(hash_keys(std::bit_cast<std::uint32_t>(first_), index));
  }

 private:
  float first_;
  std::uint64_t count_ = 0;
};

}  // namespace meristem
