// WaitingQueues: who waits for what, where most are waiting, and where for longest. Ids are small numbers, each in one
// queue at most; a queue exists while somebody waits in it, and its name is a hash. A heap of the queues finds the
// longest: adding one id costs a look-up and, mostly, no step in the heap. Of one thread at a time.
#pragma once

#include "geometry/base/key.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

namespace meristem {

class WaitingQueues {
 public:
  void add(Key name, std::uint32_t id);
  // Appends up to `most` ids of the longest queue; the last to come go first. Nothing if nobody waits.
  void take_from_longest(std::size_t most, std::vector<std::uint32_t>& ids);
  // The same of the queue that exists for longest: short ones would wait until all long ones are gone.
  void take_from_oldest(std::size_t most, std::vector<std::uint32_t>& ids);

  bool empty() const { return heap_.empty(); }
  std::size_t bytes() const;

 private:
  static constexpr std::uint32_t nobody = ~std::uint32_t(0);
  struct Queue {
    Key name;
    std::uint32_t length, last;  // the last id that came; next_ leads to those before
    std::uint64_t since;         // a number that grows from queue to queue
  };
  struct Beginning {
    Key name;
    std::uint64_t since;
  };
  struct NameIsHash {
    std::size_t operator()(Key name) const { return std::size_t(name); }
  };

  bool lasts(const Beginning& b) const;
  void take_from(std::size_t at, std::size_t most, std::vector<std::uint32_t>& ids);
  void place(Queue queue, std::size_t at);  // in the heap, where it knows its place
  void lift(std::size_t at);
  void sink(std::size_t at);

  std::vector<Queue> heap_;
  std::unordered_map<Key, std::size_t, NameIsHash> places_;  // in the heap
  std::vector<std::uint32_t> next_;                          // by id
  std::deque<Beginning> beginnings_;                         // in order, those of ended queues among them
  std::uint64_t queues_begun_ = 0;
};

}  // namespace meristem
