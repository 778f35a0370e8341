#include "renderer/session/waiting_queues.h"

#include <algorithm>

namespace meristem {

void WaitingQueues::place(Queue queue, std::size_t at) {
  places_[queue.name] = at;
  heap_[at] = queue;
}

void WaitingQueues::lift(std::size_t at) {
  const Queue queue = heap_[at];
  std::size_t to = at;
  for (; to > 0 && heap_[(to - 1) / 2].length < queue.length; to = (to - 1) / 2) place(heap_[(to - 1) / 2], to);
  if (to != at) place(queue, to);
}

void WaitingQueues::sink(std::size_t at) {
  const Queue queue = heap_[at];
  std::size_t to = at;
  for (std::size_t child; (child = 2 * to + 1) < heap_.size(); to = child) {
    if (child + 1 < heap_.size() && heap_[child + 1].length > heap_[child].length) ++child;
    if (heap_[child].length <= queue.length) break;
    place(heap_[child], to);
  }
  if (to != at) place(queue, to);
}

void WaitingQueues::add(Key name, std::uint32_t id) {
  if (id >= next_.size()) next_.resize(std::max<std::size_t>(id + 1, 2 * next_.size()), nobody);
  const auto [entry, is_new] = places_.try_emplace(name, heap_.size());
  if (is_new) heap_.push_back({name, 0, nobody});
  Queue& queue = heap_[entry->second];
  next_[id] = queue.last;
  queue.last = id;
  ++queue.length;
  lift(entry->second);
}

void WaitingQueues::take_from_longest(std::size_t most, std::vector<std::uint32_t>& ids) {
  if (heap_.empty()) return;
  Queue& queue = heap_[0];
  for (; most > 0 && queue.length > 0; --most, --queue.length) {
    ids.push_back(queue.last);
    queue.last = next_[queue.last];
  }
  if (queue.length == 0) {
    places_.erase(queue.name);
    const Queue last = heap_.back();
    heap_.pop_back();
    if (heap_.empty()) return;
    place(last, 0);
  }
  sink(0);
}

std::size_t WaitingQueues::bytes() const {
  constexpr std::size_t node_bytes = 48;  // of the map
  return heap_.capacity() * sizeof(Queue) + places_.size() * node_bytes + next_.capacity() * sizeof(std::uint32_t);
}

}  // namespace meristem
