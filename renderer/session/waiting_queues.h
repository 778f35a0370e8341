// WaitingQueues: who waits for what, and where most are waiting. Ids are small numbers, each in one queue at most; a
// queue exists while somebody waits in it, and its name is a hash. A heap of the queues finds the longest: adding one
// id costs a look-up and, mostly, no step in the heap. Of one thread at a time.
#pragma once

#include "geometry/base/key.h"

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace meristem {

class WaitingQueues {
 public:
  void add(Key name, std::uint32_t id);
  // Appends up to `most` ids of the longest queue; the last to come go first. Nothing if nobody waits.
  void take_from_longest(std::size_t most, std::vector<std::uint32_t>& ids);

  bool empty() const { return heap_.empty(); }
  std::size_t bytes() const;

 private:
  static constexpr std::uint32_t nobody = ~std::uint32_t(0);
  struct Queue {
    Key name;
    std::uint32_t length, last;  // the last id that came; next_ leads to those before
  };
  struct NameIsHash {
    std::size_t operator()(Key name) const { return std::size_t(name); }
  };

  void place(Queue queue, std::size_t at);  // in the heap, where it knows its place
  void lift(std::size_t at);
  void sink(std::size_t at);

  std::vector<Queue> heap_;
  std::unordered_map<Key, std::size_t, NameIsHash> places_;  // in the heap
  std::vector<std::uint32_t> next_;                          // by id
};

}  // namespace meristem
