#include "renderer/session/waiting_queues.h"

#include <algorithm>

namespace meristem {

void WaitingQueues::put(Index queue, std::size_t place) {
  heap_[place] = queue;
  queues_[queue].place = std::uint32_t(place);
}

void WaitingQueues::lift(std::size_t place) {
  const Index queue = heap_[place];
  const std::uint32_t length = queues_[queue].length;
  std::size_t to = place;
  for (; to > 0 && length_at((to - 1) / 2) < length; to = (to - 1) / 2) put(heap_[(to - 1) / 2], to);
  if (to != place) put(queue, to);
}

void WaitingQueues::sink(std::size_t place) {
  const Index queue = heap_[place];
  const std::uint32_t length = queues_[queue].length;
  std::size_t to = place;
  for (std::size_t child; (child = 2 * to + 1) < heap_.size(); to = child) {
    if (child + 1 < heap_.size() && length_at(child + 1) > length_at(child)) ++child;
    if (length_at(child) <= length) break;
    put(heap_[child], to);
  }
  if (to != place) put(queue, to);
}

WaitingQueues::Index WaitingQueues::queue_named(Key name) {
  const auto [entry, is_new] = by_name_.try_emplace(name, 0);
  if (!is_new) return entry->second;
  if (free_.empty()) {
    free_.push_back(Index(queues_.size()));
    queues_.emplace_back();
  }
  const Index index = entry->second = free_.back();
  free_.pop_back();
  Queue& queue = queues_[index];
  queue.name = name;
  queue.since = ++queues_begun_;
  heap_.push_back(index);
  put(index, heap_.size() - 1);
  beginnings_.push_back({index, queue.since});
  constexpr std::size_t few = 1024;
  if (beginnings_.size() > few + 2 * heap_.size()) std::erase_if(beginnings_, [&](auto& b) { return !lasts(b); });
  return index;
}

void WaitingQueues::add(std::span<const Key> names, std::uint32_t id) {
  if (id >= waiters_.size()) waiters_.resize(std::max<std::size_t>(id + 1, 2 * waiters_.size()));
  Waiter& waiter = waiters_[id];
  waiter.queue_count = std::uint32_t(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    Queue& queue = queues_[waiter.queues[i] = queue_named(names[i])];
    ++queue.length;
    constexpr std::size_t few = 64;
    if (queue.members.size() > few + 2 * queue.length)
      members_ -= std::erase_if(queue.members, [&](auto& m) { return !waits(m); });
    queue.members.push_back({id, waiter.turn});
    ++members_;
    lift(queue.place);
  }
}

std::optional<Key> WaitingQueues::take_from_longest(std::size_t most, std::vector<std::uint32_t>& ids) {
  if (heap_.empty()) return {};
  return take_from(heap_[0], most, ids);
}

bool WaitingQueues::take_from_named(Key name, std::size_t most, std::vector<std::uint32_t>& ids) {
  const auto queue = by_name_.find(name);
  if (queue == by_name_.end()) return false;
  take_from(queue->second, most, ids);
  return true;
}

std::optional<Key> WaitingQueues::take_from_oldest(std::size_t most, std::vector<std::uint32_t>& ids) {
  while (!beginnings_.empty() && !lasts(beginnings_.front())) beginnings_.pop_front();
  if (beginnings_.empty()) return {};
  return take_from(beginnings_.front().queue, most, ids);
}

bool WaitingQueues::lasts(const Beginning& b) const {
  return queues_[b.queue].length > 0 && queues_[b.queue].since == b.since;
}

Key WaitingQueues::take_from(Index index, std::size_t most, std::vector<std::uint32_t>& ids) {
  Queue& queue = queues_[index];
  const Key name = queue.name;
  for (std::size_t left = std::min<std::size_t>(most, queue.length); left > 0;) {
    const Member member = queue.members.back();
    queue.members.pop_back();
    --members_;
    if (!waits(member)) continue;
    --left;
    ids.push_back(member.id);
    Waiter& waiter = waiters_[member.id];
    ++waiter.turn;
    for (const Index other : std::span(waiter.queues).first(waiter.queue_count)) leave(other);
  }
  return name;
}

// One of those in it waits no more.
void WaitingQueues::leave(Index index) {
  Queue& queue = queues_[index];
  if (--queue.length > 0) return sink(queue.place);
  members_ -= queue.members.size();
  queue.members = {};
  by_name_.erase(queue.name);
  free_.push_back(index);
  const Index last = heap_.back();
  heap_.pop_back();
  if (queue.place == heap_.size()) return;
  put(last, queue.place);
  lift(queue.place);
  sink(queues_[last].place);
}

std::size_t WaitingQueues::bytes() const {
  constexpr std::size_t node_bytes = 48;  // of the map
  return queues_.capacity() * sizeof(Queue) + 2 * queues_.capacity() * sizeof(Index) + by_name_.size() * node_bytes +
         waiters_.capacity() * sizeof(Waiter) + 2 * members_ * sizeof(Member) + beginnings_.size() * sizeof(Beginning);
}

}  // namespace meristem
