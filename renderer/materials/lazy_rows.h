// LazyRows: the rows of a table, each made when it is first asked for. Any thread; one makes a row, others that need it
// wait; later it is an atomic load. The rows are pure, so it does not matter who made them.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>

namespace meristem {

template <class Row, std::size_t count>
class LazyRows {
 public:
  // `make(i)` returns row i.
  template <class Make>
  const Row& at(std::size_t i, Make&& make) const {
    const Row* row = made_[i].load(std::memory_order_acquire);
    if (row) return *row;
    const std::lock_guard lock(mutex_);
    if (!rows_[i]) {
      rows_[i] = std::make_unique<const Row>(make(i));
      made_[i].store(rows_[i].get(), std::memory_order_release);
    }
    return *rows_[i];
  }

 private:
  mutable std::array<std::atomic<const Row*>, count> made_{};
  mutable std::mutex mutex_;
  mutable std::array<std::unique_ptr<const Row>, count> rows_;  // guarded by mutex_
};

}  // namespace meristem
