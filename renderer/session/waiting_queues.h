// WaitingQueues: who waits for what, where most are waiting, and where for longest. Ids are small numbers; each waits
// in a queue or two and is taken from whichever is served first. A queue exists while somebody waits in it, and its
// name is a hash. A heap of the queues finds the longest: adding an id costs a look-up and, mostly, no step in the heap
// for each of its names. Who is taken stays behind in the other queues, as an entry that is passed over later: to
// unlink it would touch memory that nothing else needs. Of one thread at a time.
#pragma once

#include "geometry/base/key.h"
#include "renderer/session/block_array.h"

#include <array>
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
  // In so many one may wait.
  static constexpr std::size_t most_names = 2;
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
  using Index = std::uint32_t;  // of a queue in queues_, or of a block
  static constexpr Index none = ~Index(0);
  // An id in a queue, if that is still its turn.
  struct Entry {
    std::uint32_t id, turn;
  };
  // Of entries of one queue: a cache line.
  struct alignas(64) Block {
    Index before = none;  // of the queue; of one that is free: another such
    std::uint32_t count = 0;
    std::array<Entry, 7> entries;
  };
  struct Queue {
    Key name = 0;
    std::uint32_t length = 0;   // 0: free for another name
    std::uint32_t entries = 0;  // those of ids that were taken elsewhere among them
    std::uint32_t place = 0;    // in the heap
    Index last = none;          // block
    std::uint64_t since = 0;    // a number that grows from queue to queue
  };
  // Where an id waits now.
  struct Wait {
    std::uint32_t turn = 0;  // how often it has been taken
    std::uint32_t count = 0;
    std::array<Index, most_names> queues;
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
  void append(Queue& queue, Entry entry);
  Entry pop(Queue& queue);
  void free_last_block(Queue& queue);
  void prefetch_waits(const Queue& queue) const;
  void leave(Index queue);
  void end(Index queue);
  void sweep();  // of all queues the entries of ids that are gone
  std::uint32_t length_at(std::size_t place) const { return queues_[heap_[place]].length; }
  void put(Index queue, std::size_t place);  // in the heap
  void lift(std::size_t place);
  void sink(std::size_t place);

  std::vector<Queue> queues_;
  std::vector<Index> free_, heap_;
  std::unordered_map<Key, Index, NameIsHash> by_name_;
  BlockArray<Block> blocks_;
  Index free_block_ = none;
  std::size_t entries_ = 0, waiting_ = 0;  // of all queues; those that have not left among them
  std::vector<Entry> swept_;
  BlockArray<Wait> waits_;            // by id
  std::deque<Beginning> beginnings_;  // in order, those of ended queues among them
  std::uint64_t queues_begun_ = 0;
};

}  // namespace meristem
