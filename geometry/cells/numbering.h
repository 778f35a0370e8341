// Numbering: numbers indices in the order in which they first come up. An open hash table in one array: no allocation
// for each index.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace meristem {

class Numbering {
 public:
  // For about so many indices.
  explicit Numbering(std::size_t expected = 64)
      : slots_(std::bit_ceil(std::max(2 * expected, std::size_t(128))), none) {
    indices_.reserve(expected);
  }

  struct Added {
    std::uint32_t number;
    bool is_new;
  };
  Added add(std::uint32_t index) {
    if (2 * indices_.size() >= slots_.size()) grow();
    std::uint32_t& slot = slot_of(index);
    if (slot != none) return {slot, false};
    slot = std::uint32_t(indices_.size());
    indices_.push_back(index);
    return {slot, true};
  }
  // In the order of their numbers.
  const std::vector<std::uint32_t>& indices() const { return indices_; }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t(0);

  // Of the index, or the empty one where it belongs.
  std::uint32_t& slot_of(std::uint32_t index) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = (index * 0x9e3779b97f4a7c15ull >> 32) & mask;
    while (slots_[at] != none && indices_[slots_[at]] != index) at = (at + 1) & mask;
    return slots_[at];
  }
  void grow() {
    slots_.assign(2 * slots_.size(), none);
    for (std::uint32_t i = 0; i < indices_.size(); ++i) slot_of(indices_[i]) = i;
  }

  std::vector<std::uint32_t> slots_;  // numbers
  std::vector<std::uint32_t> indices_;
};

}  // namespace meristem
