// Scratch: arrays of working memory that a thread uses again and again, so that expanding a cell asks the allocator for
// little but what stays.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace meristem {

// `count` values that nobody has set. Its memory goes back to the thread that made it; arrays beyond a mebibyte are
// freed.
template <class T>
class Scratch {
 public:
  explicit Scratch(std::size_t count) : count_(count) {
    std::vector<std::vector<T>>& spare = spares();
    if (!spare.empty()) {
      values_ = std::move(spare.back());
      spare.pop_back();
    }
    if (values_.size() < count) values_.resize(count);
  }
  Scratch(std::size_t count, const T& value) : Scratch(count) { std::fill_n(values_.begin(), count, value); }
  ~Scratch() {
    constexpr std::size_t most_bytes = std::size_t(1) << 20, most_spares = 32;
    if (values_.size() * sizeof(T) <= most_bytes && spares().size() < most_spares)
      spares().push_back(std::move(values_));
  }
  Scratch(Scratch&& other) noexcept : values_(std::move(other.values_)), count_(std::exchange(other.count_, 0)) {}
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  T& operator[](std::size_t i) { return values_[i]; }
  const T& operator[](std::size_t i) const { return values_[i]; }
  T* data() { return values_.data(); }
  const T* data() const { return values_.data(); }
  std::size_t size() const { return count_; }
  std::span<T> span() { return {values_.data(), count_}; }
  std::span<const T> span() const { return {values_.data(), count_}; }

 private:
  static std::vector<std::vector<T>>& spares() {
    thread_local std::vector<std::vector<T>> list;
    return list;
  }

  std::vector<T> values_;
  std::size_t count_;
};

}  // namespace meristem
