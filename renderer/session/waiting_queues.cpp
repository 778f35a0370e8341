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
  while (waits_.size() <= id) waits_.grow();
  Wait& wait = waits_[id];
  wait.count = std::uint32_t(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Index index = wait.queues[i] = queue_named(names[i]);
    Queue& queue = queues_[index];
    append(queue, {id, wait.turn});
    ++queue.length;
    lift(queue.place);
  }
  entries_ += names.size(), waiting_ += names.size();
  constexpr std::size_t few = 4096;
  if (entries_ > few + 2 * waiting_) sweep();
}

void WaitingQueues::append(Queue& queue, Entry entry) {
  if (queue.last == none || blocks_[queue.last].count == blocks_[queue.last].entries.size()) {
    if (free_block_ == none) free_block_ = Index(blocks_.grow());
    const Index block = std::exchange(free_block_, blocks_[free_block_].before);
    blocks_[block].before = std::exchange(queue.last, block);
  }
  Block& last = blocks_[queue.last];
  last.entries[last.count++] = entry;
  ++queue.entries;
}

WaitingQueues::Entry WaitingQueues::pop(Queue& queue) {
  Block& last = blocks_[queue.last];
  const Entry entry = last.entries[--last.count];
  --queue.entries;
  if (last.count == 0) {
    free_last_block(queue);
    prefetch_waits(queue);
  }
  return entry;
}

void WaitingQueues::free_last_block(Queue& queue) {
  Block& last = blocks_[queue.last];
  last.count = 0;
  const Index before = std::exchange(last.before, free_block_);
  free_block_ = std::exchange(queue.last, before);
}

// Of the ids that will come next, and the block after theirs.
void WaitingQueues::prefetch_waits(const Queue& queue) const {
  if (queue.last == none) return;
  const Block& last = blocks_[queue.last];
  for (std::uint32_t i = 0; i < last.count; ++i) __builtin_prefetch(&waits_[last.entries[i].id]);
  if (last.before != none) __builtin_prefetch(&blocks_[last.before]);
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
  prefetch_waits(queues_[index]);
  for (std::size_t left = std::min<std::size_t>(most, queues_[index].length); left > 0;) {
    const Entry entry = pop(queues_[index]);
    --entries_;
    Wait& wait = waits_[entry.id];
    if (wait.turn != entry.turn) continue;
    ids.push_back(entry.id);
    ++wait.turn;
    for (std::uint32_t i = 0; i < wait.count; ++i) leave(wait.queues[i]);
    --left;
  }
  return name;
}

void WaitingQueues::leave(Index index) {
  Queue& queue = queues_[index];
  --waiting_;
  if (--queue.length > 0) return sink(queue.place);
  end(index);
}

void WaitingQueues::sweep() {
  for (const Index index : heap_) {
    Queue& queue = queues_[index];
    swept_.clear();
    while (queue.last != none) {
      const Block& last = blocks_[queue.last];
      for (std::uint32_t i = last.count; i-- > 0;)
        if (waits_[last.entries[i].id].turn == last.entries[i].turn) swept_.push_back(last.entries[i]);
      free_last_block(queue);
    }
    queue.entries = 0;
    for (std::size_t i = swept_.size(); i-- > 0;) append(queue, swept_[i]);
  }
  entries_ = waiting_;
}

void WaitingQueues::end(Index index) {
  Queue& queue = queues_[index];
  entries_ -= std::exchange(queue.entries, 0);
  while (queue.last != none) free_last_block(queue);
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
         by_name_.size() * node_bytes + by_name_.bucket_count() * sizeof(void*) + blocks_.bytes() + waits_.bytes() +
         swept_.capacity() * sizeof(Entry) + beginnings_.size() * sizeof(Beginning);
}

}  // namespace meristem
