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

WaitingQueues::Queue& WaitingQueues::queue_named(Key name) {
  const auto [entry, is_new] = places_.try_emplace(name, heap_.size());
  if (!is_new) return heap_[entry->second];
  if (free_lists_.empty()) {
    free_lists_.push_back(std::uint32_t(lists_.size()));
    lists_.emplace_back();
  }
  heap_.push_back({name, 0, free_lists_.back(), ++queues_begun_});
  free_lists_.pop_back();
  beginnings_.push_back({name, queues_begun_});
  constexpr std::size_t few = 1024;
  if (beginnings_.size() > few + 2 * heap_.size()) std::erase_if(beginnings_, [&](auto& b) { return !lasts(b); });
  return heap_.back();
}

void WaitingQueues::add(std::span<const Key> names, std::uint32_t id) {
  if (id >= waiters_.size()) waiters_.resize(std::max<std::size_t>(id + 1, 2 * waiters_.size()));
  Waiter& waiter = waiters_[id];
  waiter.name_count = std::uint32_t(names.size());
  std::ranges::copy(names, waiter.names.begin());
  for (const Key name : names) {
    Queue& queue = queue_named(name);
    ++queue.length;
    std::vector<Member>& list = lists_[queue.list];
    constexpr std::size_t few = 64;
    if (list.size() > few + 2 * queue.length) members_ -= std::erase_if(list, [&](auto& m) { return !waits(m); });
    list.push_back({id, waiter.turn});
    ++members_;
    lift(places_[name]);
  }
}

std::optional<Key> WaitingQueues::take_from_longest(std::size_t most, std::vector<std::uint32_t>& ids) {
  if (heap_.empty()) return {};
  return take_from(0, most, ids);
}

std::optional<Key> WaitingQueues::take_from_oldest(std::size_t most, std::vector<std::uint32_t>& ids) {
  while (!beginnings_.empty() && !lasts(beginnings_.front())) beginnings_.pop_front();
  if (beginnings_.empty()) return {};
  return take_from(places_[beginnings_.front().name], most, ids);
}

bool WaitingQueues::lasts(const Beginning& b) const {
  const auto place = places_.find(b.name);
  return place != places_.end() && heap_[place->second].since == b.since;
}

Key WaitingQueues::take_from(std::size_t at, std::size_t most, std::vector<std::uint32_t>& ids) {
  const Queue queue = heap_[at];
  std::vector<Member>& list = lists_[queue.list];
  for (std::size_t left = std::min<std::size_t>(most, queue.length); left > 0;) {
    const Member member = list.back();
    list.pop_back();
    --members_;
    if (!waits(member)) continue;
    --left;
    ids.push_back(member.id);
    Waiter& waiter = waiters_[member.id];
    ++waiter.turn;
    for (const Key name : std::span(waiter.names).first(waiter.name_count)) leave(name);
  }
  return queue.name;
}

// One of those in it waits no more.
void WaitingQueues::leave(Key name) {
  const auto entry = places_.find(name);
  const std::size_t at = entry->second;
  if (--heap_[at].length > 0) return sink(at);
  clear_list(heap_[at].list);
  places_.erase(entry);
  const Queue last = heap_.back();
  heap_.pop_back();
  if (at == heap_.size()) return;
  place(last, at);
  lift(at);
  sink(places_[last.name]);
}

void WaitingQueues::clear_list(std::uint32_t list) {
  members_ -= lists_[list].size();
  lists_[list] = {};
  free_lists_.push_back(list);
}

std::size_t WaitingQueues::bytes() const {
  constexpr std::size_t node_bytes = 48;  // of the map
  return heap_.capacity() * sizeof(Queue) + places_.size() * node_bytes + waiters_.capacity() * sizeof(Waiter) +
         2 * members_ * sizeof(Member) + lists_.size() * sizeof(lists_[0]) + beginnings_.size() * sizeof(Beginning);
}

}  // namespace meristem
