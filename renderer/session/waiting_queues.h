// WaitingQueues: who waits for what, where most are waiting, and where for longest. Ids are small numbers; each waits
// in a few queues and is taken from whichever is served first. A queue exists while somebody waits in it, and its name
// is a hash. A heap of the queues finds the longest: adding an id costs a look-up and, mostly, no step in the heap for
// each of its names; taking it the same without a look-up. Of one thread at a time.
#pragma once

#include "geometry/accel/ray_search.h"
#include "geometry/base/key.h"
#include "renderer/session/block_array.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <tuple>
#include <unordered_map>
#include <vector>

namespace meristem {

class WaitingQueues {
 public:
  // In so many one may wait.
  static constexpr std::size_t most_names = 2 * std::tuple_size_v<CellList::Names>;
  // An id that waits nowhere; at least one name, each once.
  void add(std::span<const Key> names, std::uint32_t id);
  // Appends up to `most` ids of the longest queue; the last to come go first, and wait nowhere any more. Returns the
  // queue's name; nothing if nobody waits.
  std::optional<Key> take_from_longest(std::size_t most, std::vector<std::uint32_t>& ids);
  // The same of a queue by its name; false if nobody waits there.
  bool take_from_named(Key name, std::size_t most, std::vector<std::uint32_t>& ids);
  // The same of the queue that exists for longest: short ones would wait until all long ones are gone.
  std::optional<Key> take_from_oldest(std::size_t most, std::vector<std::uint32_t>& ids);

  bool empty() const { return heap_.empty(); }
  std::size_t bytes() const;

 private:
  using Index = std::uint32_t;  // of a queue in queues_, or of a member
  static constexpr Index none = ~Index(0);
  // An id in a queue.
  struct Member {
    std::uint32_t id;
    Index queue;
    Index before, after;     // in the queue
    Index in_another_queue;  // of the id; of one that is free: another such
  };
  struct Queue {
    Key name = 0;
    std::uint32_t length = 0;  // 0: free for another name
    std::uint32_t place = 0;   // in the heap
    std::uint64_t since = 0;   // a number that grows from queue to queue
    Index last = none;         // that came
  };
  struct Beginning {
    Index queue;
    std::uint64_t since;
  };
  struct NameIsHash {
    std::size_t operator()(Key name) const { return std::size_t(name); }
  };

  bool lasts(const Beginning& b) const;
  Index queue_named(Key name);
  Key take_from(Index queue, std::size_t most, std::vector<std::uint32_t>& ids);
  void join(std::uint32_t id, Index queue);
  void leave(const Member& member);
  void end(Index queue);
  std::uint32_t length_at(std::size_t place) const { return queues_[heap_[place]].length; }
  void put(Index queue, std::size_t place);  // in the heap
  void lift(std::size_t place);
  void sink(std::size_t place);

  std::vector<Queue> queues_;
  std::vector<Index> free_, heap_;
  std::unordered_map<Key, Index, NameIsHash> by_name_;
  BlockArray<Member> members_;
  Index free_member_ = none;
  std::vector<Index> waits_;          // by id, one of its members; none: it waits nowhere
  std::deque<Beginning> beginnings_;  // in order, those of ended queues among them
  std::uint64_t queues_begun_ = 0;
};

}  // namespace meristem
