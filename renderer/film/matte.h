// Matte: how much of each pixel shows each thing of a kind (objects, materials, rules), as whole weights of samples: so
// mattes are exact, and can be merged in any order. Threads may add to different pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace meristem {

struct MatteEntry {
  std::int32_t thing = 0;   // its number
  std::int32_t weight = 0;  // of the samples that show it
};

class Matte {
 public:
  Matte() = default;  // of no pixels: not wanted
  explicit Matte(std::size_t pixels) : pixels_(pixels) {}

  bool empty() const { return pixels_.empty(); }
  std::size_t pixel_count() const { return pixels_.size(); }
  void add(std::size_t pixel, MatteEntry entry);
  void merge(const Matte& other);
  const std::vector<MatteEntry>& entries(std::size_t pixel) const { return pixels_[pixel]; }  // by number

 private:
  std::vector<std::vector<MatteEntry>> pixels_;  // each sorted by number
};

}  // namespace meristem
