// BlockArray: an array that grows without moving what is in it. It comes in blocks, so it never holds twice what it
// needs, and what stays for long does not lie in small pieces among the arrays of cells that come and go.
#pragma once

#include <bit>
#include <cstddef>
#include <memory>
#include <vector>

namespace meristem {

template <class T>
class BlockArray {
 public:
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T& operator[](std::size_t i) { return blocks_[i / block_size][i % block_size]; }
  const T& operator[](std::size_t i) const { return blocks_[i / block_size][i % block_size]; }
  // Appends one; its index.
  std::size_t grow() {
    if (size_ == blocks_.size() * block_size) blocks_.push_back(std::make_unique<T[]>(block_size));
    return size_++;
  }
  std::size_t bytes() const { return blocks_.size() * block_size * sizeof(T) + blocks_.capacity() * sizeof(void*); }

 private:
  static constexpr std::size_t block_size = std::bit_floor((std::size_t(1) << 16) / sizeof(T));
  std::vector<std::unique_ptr<T[]>> blocks_;
  std::size_t size_ = 0;
};

}  // namespace meristem
