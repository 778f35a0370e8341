#include "renderer/session/waiting_queues.h"

#include <algorithm>
#include <utility>

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
  constexpr std::size_t few = 1024;
  if (beginnings_.size() > few + 2 * heap_.size()) std::erase_if(beginnings_, [&](auto& b) { return !lasts(b); });
  beginnings_.push_back({index, queue.since});
  return index;
}

void WaitingQueues::add(std::span<const Key> names, std::uint32_t id) {
  if (id >= waits_.size()) waits_.resize(id + 1, none);
  for (const Key name : names) join(id, queue_named(name));
}

void WaitingQueues::join(std::uint32_t id, Index index) {
  if (free_member_ == none) {
    free_member_ = Index(members_.grow());
    members_[free_member_].in_another_queue = none;
  }
  const Index i = free_member_;
  Member& member = members_[i];
  free_member_ = member.in_another_queue;
  Queue& queue = queues_[index];
  member = {id, index, queue.last, none, waits_[id]};
  if (queue.last != none) members_[queue.last].after = i;
  queue.last = waits_[id] = i;
  ++queue.length;
  lift(queue.place);
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
  const Key name = queues_[index].name;
  for (std::size_t left = std::min<std::size_t>(most, queues_[index].length); left > 0; --left) {
    const std::uint32_t id = members_[queues_[index].last].id;
    ids.push_back(id);
    for (Index i = std::exchange(waits_[id], none); i != none;) {
      Member& member = members_[i];
      leave(member);
      const Index next = std::exchange(member.in_another_queue, free_member_);
      free_member_ = std::exchange(i, next);
    }
  }
  return name;
}

void WaitingQueues::leave(const Member& member) {
  Queue& queue = queues_[member.queue];
  if (member.before != none) members_[member.before].after = member.after;
  (member.after != none ? members_[member.after].before : queue.last) = member.before;
  if (--queue.length > 0) return sink(queue.place);
  end(member.queue);
}

void WaitingQueues::end(Index index) {
  const Queue& queue = queues_[index];
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
  constexpr std::size_t node_bytes = 32;  // of the map, with what malloc adds
  return queues_.capacity() * sizeof(Queue) + (free_.capacity() + heap_.capacity()) * sizeof(Index) +
         by_name_.size() * node_bytes + by_name_.bucket_count() * sizeof(void*) + members_.bytes() +
         waits_.capacity() * sizeof(Index) + beginnings_.size() * sizeof(Beginning);
}

}  // namespace meristem
