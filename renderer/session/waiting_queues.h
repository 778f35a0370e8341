// WaitingQueues: who waits for what, where most are waiting, and where for longest. Ids are small numbers; each waits
// in a few queues and is taken from whichever is served first. A queue exists while somebody waits in it, and its name
// is a hash. A heap of the queues finds the longest: adding an id costs a look-up and, mostly, no step in the heap for
// each of its names; taking it the same. Of one thread at a time.
#pragma once

#include "geometry/accel/ray_search.h"
#include "geometry/base/key.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace meristem {

class WaitingQueues {
 public:
  // An id that waits nowhere; at least one name, each once.
  void add(std::span<const Key> names, std::uint32_t id);
  // Appends up to `most` ids of the longest queue; the last to come go first, and wait nowhere any more. Returns the
  // queue's name; nothing if nobody waits.
  std::optional<Key> take_from_longest(std::size_t most, std::vector<std::uint32_t>& ids);
  // The same of the queue that exists for longest: short ones would wait until all long ones are gone.
  std::optional<Key> take_from_oldest(std::size_t most, std::vector<std::uint32_t>& ids);

  bool empty() const { return heap_.empty(); }
  std::size_t bytes() const;

 private:
  // In a queue's list those that were taken from another stay for a while; they are known by an old turn.
  struct Member {
    std::uint32_t id, turn;
  };
  struct Queue {
    Key name;
    std::uint32_t length, list;  // of those that wait; its place in lists_
    std::uint64_t since;         // a number that grows from queue to queue
  };
  struct Waiter {
    std::uint32_t turn = 0;  // how often it has been taken
    std::uint32_t name_count = 0;
    MissingCells::Names names;
  };
  struct Beginning {
    Key name;
    std::uint64_t since;
  };
  struct NameIsHash {
    std::size_t operator()(Key name) const { return std::size_t(name); }
  };

  bool waits(const Member& m) const { return waiters_[m.id].turn == m.turn; }
  bool lasts(const Beginning& b) const;
  Queue& queue_named(Key name);
  Key take_from(std::size_t at, std::size_t most, std::vector<std::uint32_t>& ids);
  void leave(Key name);
  void clear_list(std::uint32_t list);
  void place(Queue queue, std::size_t at);  // in the heap, where it knows its place
  void lift(std::size_t at);
  void sink(std::size_t at);

  std::vector<Queue> heap_;
  std::unordered_map<Key, std::size_t, NameIsHash> places_;  // in the heap
  std::vector<std::vector<Member>> lists_;
  std::vector<std::uint32_t> free_lists_;
  std::size_t members_ = 0;           // in all lists
  std::vector<Waiter> waiters_;       // by id
  std::deque<Beginning> beginnings_;  // in order, those of ended queues among them
  std::uint64_t queues_begun_ = 0;
};

}  // namespace meristem
