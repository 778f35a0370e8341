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
  if (is_new) {
    heap_.push_back({name, 0, nobody, ++queues_begun_});
    beginnings_.push_back({name, queues_begun_});
    constexpr std::size_t few = 1024;
    if (beginnings_.size() > few + 2 * heap_.size()) std::erase_if(beginnings_, [&](auto& b) { return !lasts(b); });
  }
  Queue& queue = heap_[entry->second];
  next_[id] = queue.last;
  queue.last = id;
  ++queue.length;
  lift(entry->second);
}

void WaitingQueues::take_from_longest(std::size_t most, std::vector<std::uint32_t>& ids) {
  if (!heap_.empty()) take_from(0, most, ids);
}

void WaitingQueues::take_from_oldest(std::size_t most, std::vector<std::uint32_t>& ids) {
  while (!beginnings_.empty() && !lasts(beginnings_.front())) beginnings_.pop_front();
  if (!beginnings_.empty()) take_from(places_[beginnings_.front().name], most, ids);
}

bool WaitingQueues::lasts(const Beginning& b) const {
  const auto place = places_.find(b.name);
  return place != places_.end() && heap_[place->second].since == b.since;
}

void WaitingQueues::take_from(std::size_t at, std::size_t most, std::vector<std::uint32_t>& ids) {
  Queue& queue = heap_[at];
  for (; most > 0 && queue.length > 0; --most, --queue.length) {
    ids.push_back(queue.last);
    queue.last = next_[queue.last];
  }
  if (queue.length == 0) {
    places_.erase(queue.name);
    const Queue last = heap_.back();
    heap_.pop_back();
    if (at == heap_.size()) return;
    place(last, at);
    lift(at);
  }
  sink(at);
}

std::size_t WaitingQueues::bytes() const {
  constexpr std::size_t node_bytes = 48;  // of the map
  return heap_.capacity() * sizeof(Queue) + places_.size() * node_bytes + next_.capacity() * sizeof(std::uint32_t) +
         beginnings_.size() * sizeof(Beginning);
}

}  // namespace meristem
