#include "geometry/cache/geometry_cache.h"

#include "geometry/base/check.h"
#include "geometry/cache/expansion_recorder.h"

#include <algorithm>

namespace meristem {

namespace {

// The indices of threads that live now: the smallest free one for each, so that threads which come and go share few.
class ThreadIndices {
 public:
  int take() {
    const std::lock_guard lock(mutex_);
    const auto free = std::find(is_taken_.begin(), is_taken_.end(), false);
    CHECK(free != is_taken_.end(), "{} threads use a geometry cache at once; the limit is {}",
          GeometryCache::max_threads + 1, GeometryCache::max_threads);
    *free = true;
    const int index = int(free - is_taken_.begin());
    if (index >= count_.load()) count_.store(index + 1);
    return index;
  }
  void give_back(int index) {
    const std::lock_guard lock(mutex_);
    is_taken_[std::size_t(index)] = false;
  }
  // Every index ever taken is below; grows before the thread that makes it grow enters a cache.
  int count() const { return count_.load(); }

 private:
  std::mutex mutex_;
  std::array<bool, GeometryCache::max_threads> is_taken_{};
  std::atomic<int> count_{0};
};

ThreadIndices thread_indices;

struct ThreadIndexLease {
  const int index = thread_indices.take();
  ThreadIndexLease() = default;
  ~ThreadIndexLease() { thread_indices.give_back(index); }
  ThreadIndexLease(const ThreadIndexLease&) = delete;
  ThreadIndexLease& operator=(const ThreadIndexLease&) = delete;
};

}  // namespace

CacheSlot::State CacheSlot::state() const {
  const std::uintptr_t word = word_.load(std::memory_order_acquire);
  return word > failed ? State::Resident : State(word);
}

GeometryCache::~GeometryCache() {
  for (CacheEntry* entry : limbo_) delete entry;
  for (CacheEntry* entry : clock_) delete entry;
}

int GeometryCache::thread_index() {
  thread_local const ThreadIndexLease lease;
  return lease.index;
}

CacheEntry* GeometryCache::acquire_slow(CacheSlot& slot, CacheEntry* parent, const Expand& expand) {
  while (true) {
    std::uintptr_t word = slot.word_.load();
    if (word > CacheSlot::failed) return reinterpret_cast<CacheEntry*>(word);
    if (word == CacheSlot::failed) return nullptr;
    if (word == CacheSlot::expanding) {
      wait_for(slot);
      continue;
    }
    if (slot.word_.compare_exchange_strong(word, CacheSlot::expanding, std::memory_order_acq_rel))
      return expand_slot(slot, parent, expand);
  }
}

void GeometryCache::wait_for(const CacheSlot& slot) {
  waits_.fetch_add(1, std::memory_order_relaxed);
  const double start_s = recorder_ ? recorder_->now_s() : 0;
  slot.word_.wait(CacheSlot::expanding, std::memory_order_acquire);
  if (recorder_) recorder_->add_wait(start_s);
}

CacheEntry* GeometryCache::expand_slot(CacheSlot& slot, CacheEntry* parent, const Expand& expand) {
  const bool is_orphan = !adopt_child(parent);
  std::unique_ptr<CacheEntry> entry;
  try {
    entry = expand();
  } catch (...) {  // the cell fails, not the frame: it is drawn as its bounds, counted and reported
    publish_failure(slot, parent, is_orphan);
    return nullptr;
  }
  CacheEntry* result = entry.get();
  publish(slot, parent, std::move(entry), is_orphan);
  return result;
}

// Keeps the parent resident while a child is being expanded. False if the parent was evicted meanwhile (its memory is
// still valid for this thread): then the child is used once and thrown away.
bool GeometryCache::adopt_child(CacheEntry* parent) {
  if (!parent) return true;
  const std::lock_guard lock(mutex_);
  if (parent->evicted_) return false;
  ++parent->children_;
  return true;
}

void GeometryCache::publish(CacheSlot& slot, CacheEntry* parent, std::unique_ptr<CacheEntry> owned, bool is_orphan) {
  CacheEntry* entry = owned.release();
  ThreadCounts& mine = threads_[std::size_t(thread_index())].counts;
  ++mine.expansions;
  mine.reexpansions += slot.was_expanded_;
  {
    const std::lock_guard lock(mutex_);
    ++statistics_.expansions;
    statistics_.reexpansions += slot.was_expanded_;
    slot.was_expanded_ = true;
    entry->slot_ = &slot;
    entry->parent_ = parent;
    if (recorder_) recorder_->expanded(entry->label, entry->bytes);
    if (is_orphan) {
      entry->evicted_ = true;
      send_to_limbo(entry);
    } else {
      entry->clock_index_ = clock_.size();
      clock_.push_back(entry);
      statistics_.resident_bytes += entry->bytes;
      evict_to_budget(entry);
      statistics_.resident_bytes_peak = std::max(statistics_.resident_bytes_peak, statistics_.resident_bytes);
    }
    slot.word_.store(reinterpret_cast<std::uintptr_t>(entry), std::memory_order_release);
    reclaim();
  }
  slot.word_.notify_all();
}

void GeometryCache::publish_failure(CacheSlot& slot, CacheEntry* parent, bool is_orphan) {
  {
    const std::lock_guard lock(mutex_);
    ++statistics_.failures;
    if (parent && !is_orphan) --parent->children_;
  }
  slot.word_.store(CacheSlot::failed, std::memory_order_release);
  slot.word_.notify_all();
}

void GeometryCache::evict_to_budget(const CacheEntry* keep) {
  // Two rounds of the hand: the first clears used bits, the second takes what nobody asked for since.
  for (std::size_t looked_at = 0; statistics_.resident_bytes > budget_bytes_ && looked_at < 2 * clock_.size() + 2;
       ++looked_at) {
    if (hand_ >= clock_.size()) hand_ = 0;
    CacheEntry& entry = *clock_[hand_];
    if (&entry == keep || entry.children_ > 0)
      ++hand_;
    else if (entry.used_.exchange(false, std::memory_order_relaxed))
      ++hand_;
    else
      evict(entry);  // the last entry takes its place under the hand
  }
}

void GeometryCache::evict(CacheEntry& entry) {
  clock_[entry.clock_index_] = clock_.back();
  clock_[entry.clock_index_]->clock_index_ = entry.clock_index_;
  clock_.pop_back();
  statistics_.resident_bytes -= entry.bytes;
  ++statistics_.evictions;
  if (entry.parent_) --entry.parent_->children_;
  entry.evicted_ = true;
  entry.slot_->word_.store(CacheSlot::empty);
  send_to_limbo(&entry);
}

// An entry in limbo may be freed once every thread inside has entered at a later epoch. The increment is a full barrier
// between emptying the slot and reading the threads' epochs: a thread that still found the entry is seen to be inside.
void GeometryCache::send_to_limbo(CacheEntry* entry) {
  entry->evicted_epoch_ = epoch_.fetch_add(1);
  limbo_.push_back(entry);
  statistics_.limbo_bytes += entry->bytes;
  statistics_.limbo_bytes_peak = std::max(statistics_.limbo_bytes_peak, statistics_.limbo_bytes);
  if (recorder_) recorder_->evicted(entry->label, entry->bytes);
}

std::uint64_t GeometryCache::oldest_epoch() const {
  std::uint64_t oldest = outside;
  const int count = thread_indices.count();
  for (int i = 0; i < count; ++i) oldest = std::min(oldest, threads_[std::size_t(i)].epoch.load());
  return oldest;
}

void GeometryCache::reclaim() {
  if (limbo_.empty()) return;
  const std::uint64_t oldest = oldest_epoch();
  const auto first_kept =
      std::find_if(limbo_.begin(), limbo_.end(), [&](const CacheEntry* e) { return e->evicted_epoch_ >= oldest; });
  for (auto it = limbo_.begin(); it != first_kept; ++it) {
    statistics_.limbo_bytes -= (*it)->bytes;
    delete *it;
  }
  limbo_.erase(limbo_.begin(), first_kept);
  if (recorder_) recorder_->limbo_is(statistics_.limbo_bytes);
}

CacheStatistics GeometryCache::statistics() const {
  const std::lock_guard lock(mutex_);
  CacheStatistics result = statistics_;
  result.waits = waits_.load(std::memory_order_relaxed);
  return result;
}

}  // namespace meristem
