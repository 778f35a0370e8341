#include "geometry/cache/geometry_cache.h"

#include "geometry/base/check.h"
#include "geometry/base/process_memory.h"
#include "geometry/cache/expansion_recorder.h"

#include <algorithm>
#include <thread>

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

// While one lives, its thread is not inside, but holds the entries that its ray uses.
class GeometryCache::Absence {
 public:
  Absence(GeometryCache& cache, CacheEntry* parent, const RayUse& use)
      : cache_(cache), mine_(cache.threads_[std::size_t(thread_index())]), was_inside_(mine_.epoch.load() != outside) {
    const std::lock_guard lock(cache_.mutex_);
    if (parent) hold(*parent);
    if (use.nearest) hold(*use.nearest);
    for (const UsedEntry* used = use.cells; used; used = used->outer) hold(*used->entry);
    mine_.epoch.store(outside);
  }
  ~Absence() {
    mine_.counts.nanoseconds += std::uint64_t(std::chrono::nanoseconds(Clock::now() - started_).count());
    const std::lock_guard lock(cache_.mutex_);
    if (was_inside_) cache_.enter(mine_.epoch);
    for (CacheEntry* entry : held_) cache_.release(*entry);
  }
  Absence(const Absence&) = delete;
  Absence& operator=(const Absence&) = delete;

  void hold(CacheEntry& entry) {  // needs mutex_
    if (entry.holds_++ == 0 && entry.evicted_) std::erase(cache_.limbo_, &entry);
    held_.push_back(&entry);
  }

 private:
  using Clock = std::chrono::steady_clock;

  GeometryCache& cache_;
  ThreadEpoch& mine_;
  const bool was_inside_;
  const Clock::time_point started_ = Clock::now();
  std::vector<CacheEntry*> held_;
};

CacheEntry* GeometryCache::acquire_slow(CacheSlot& slot, CacheEntry* parent, const RayUse& use, const Expand& expand) {
  while (true) {
    std::uintptr_t word = slot.word_.load();
    if (word > CacheSlot::failed) return reinterpret_cast<CacheEntry*>(word);
    if (word == CacheSlot::failed) return nullptr;
    Absence absence(*this, parent, use);
    if (word == CacheSlot::expanding)
      wait_for(slot);
    else if (slot.word_.compare_exchange_strong(word, CacheSlot::expanding, std::memory_order_acq_rel))
      return expand_slot(slot, parent, absence, expand);
  }
}

void GeometryCache::wait_for(const CacheSlot& slot) {
  waits_.fetch_add(1, std::memory_order_relaxed);
  const double start_s = recorder_ ? recorder_->now_s() : 0;
  slot.word_.wait(CacheSlot::expanding, std::memory_order_acquire);
  if (recorder_) recorder_->add_wait(start_s);
}

CacheEntry* GeometryCache::expand_slot(CacheSlot& slot, CacheEntry* parent, Absence& absence, const Expand& expand) {
  make_room();
  std::unique_ptr<CacheEntry> entry;
  try {
    entry = expand();
  } catch (...) {  // the cell fails, not the frame: it is drawn as its bounds, counted and reported
    publish_failure(slot);
    return nullptr;
  }
  CacheEntry* result = entry.get();
  publish(slot, parent, absence, std::move(entry));
  return result;
}

// Waits until what has been evicted is freed, if there is more than the budget. Those who can keep it are inside, so
// they only trace, and soon leave or come here themselves.
void GeometryCache::make_room() {
  constexpr int yields = 16;
  const auto start = std::chrono::steady_clock::now();
  for (int round = 0;; ++round) {
    Garbage garbage;
    {
      const std::lock_guard lock(mutex_);
      evict_to_budget();
      garbage = reclaim();
      if (limbo_.empty() || statistics_.resident_bytes + statistics_.limbo_bytes <= entry_budget()) return;
      if (std::chrono::steady_clock::now() - start > patience) {
        ++statistics_.overdrafts;
        return;
      }
    }
    if (round < yields)
      std::this_thread::yield();
    else
      std::this_thread::sleep_for(std::chrono::microseconds(50));
  }
}

// Makes the entry resident; or, if its parent was evicted while a ray still used it, gives it to its thread alone.
void GeometryCache::publish(CacheSlot& slot, CacheEntry* parent, Absence& absence, std::unique_ptr<CacheEntry> owned) {
  CacheEntry* entry = owned.release();
  ThreadCounts& mine = threads_[std::size_t(thread_index())].counts;
  ++mine.expansions;
  mine.reexpansions += slot.was_expanded();
  Garbage garbage;
  bool looks_at_freed;
  {
    const std::lock_guard lock(mutex_);
    ++statistics_.expansions;
    statistics_.reexpansions += slot.was_expanded();
    slot.was_expanded_.store(true, std::memory_order_relaxed);
    if (recorder_) recorder_->expanded(entry->label, entry->bytes);
    absence.hold(*entry);
    if (parent && parent->evicted_) {
      add_to_limbo(*entry);
      slot.word_.store(CacheSlot::empty);
    } else {
      add_resident(slot, parent, entry);
      slot.word_.store(reinterpret_cast<std::uintptr_t>(entry), std::memory_order_release);
    }
    evict_to_budget();
    note_peaks();
    garbage = reclaim();
    looks_at_freed = must_look_at_freed();
  }
  slot.word_.notify_all();
  garbage.clear();
  if (looks_at_freed) give_back_if_grown();
}

void GeometryCache::publish_failure(CacheSlot& slot) {
  {
    const std::lock_guard lock(mutex_);
    ++statistics_.failures;
  }
  slot.word_.store(CacheSlot::failed, std::memory_order_release);
  slot.word_.notify_all();
}

void GeometryCache::add_resident(CacheSlot& slot, CacheEntry* parent, CacheEntry* entry) {
  entry->slot_ = &slot;
  entry->parent_ = parent;
  if (parent) ++parent->children_;
  entry->clock_index_ = clock_.size();
  clock_.push_back(entry);
  names_[entry->name % name_buckets].fetch_add(1, std::memory_order_relaxed);
  statistics_.resident_bytes += entry->bytes;
}

std::size_t GeometryCache::entry_budget() const {
  const std::size_t others = other_bytes_ ? other_bytes_() : 0;
  return budget_bytes_ - std::min(budget_bytes_, others);
}

void GeometryCache::note_peaks() {
  CacheStatistics& s = statistics_;
  s.resident_bytes_peak = std::max(s.resident_bytes_peak, s.resident_bytes);
  s.limbo_bytes_peak = std::max(s.limbo_bytes_peak, s.limbo_bytes);
  const std::size_t others = other_bytes_ ? other_bytes_() : 0;
  s.total_bytes_peak = std::max(s.total_bytes_peak, s.resident_bytes + s.limbo_bytes + others);
}

void GeometryCache::evict_to_budget() {
  const std::size_t budget = entry_budget();
  // Two rounds of the hand: the first clears used bits, the second takes what nobody asked for since.
  for (std::size_t looked_at = 0; statistics_.resident_bytes > budget && looked_at < 2 * (clock_.size() - kept_) + 2;
       ++looked_at) {
    if (kept_ > 0) is_crowded_.store(true, std::memory_order_relaxed);
    if (hand_ >= clock_.size()) hand_ = kept_;
    if (hand_ >= clock_.size()) return;
    CacheEntry& entry = *clock_[hand_];
    if (entry.holds_ > 0 || entry.children_ > 0)
      ++hand_;
    else if (entry.used_.exchange(false, std::memory_order_relaxed))
      ++hand_;
    else
      evict(entry);  // the last entry takes its place under the hand
  }
}

void GeometryCache::keep_resident() {
  const std::lock_guard lock(mutex_);
  kept_ = clock_.size();
  hand_ = kept_;
}

void GeometryCache::release_kept() {
  const std::lock_guard lock(mutex_);
  kept_ = 0;
  is_crowded_.store(false, std::memory_order_relaxed);
}

void GeometryCache::evict(CacheEntry& entry) {
  clock_[entry.clock_index_] = clock_.back();
  clock_[entry.clock_index_]->clock_index_ = entry.clock_index_;
  clock_.pop_back();
  statistics_.resident_bytes -= entry.bytes;
  evicted_bytes_ += entry.bytes;
  ++statistics_.evictions;
  if (entry.parent_) --entry.parent_->children_;
  names_[entry.name % name_buckets].fetch_sub(1, std::memory_order_relaxed);
  entry.slot_->word_.store(CacheSlot::empty);
  add_to_limbo(entry);
}

// An entry in limbo may be freed once nobody holds it and every thread inside has entered at a later epoch. The
// increment is a full barrier between emptying the slot and reading the threads' epochs: a thread that still found the
// entry is seen to be inside.
void GeometryCache::add_to_limbo(CacheEntry& entry) {
  entry.evicted_ = true;
  statistics_.limbo_bytes += entry.bytes;
  if (recorder_) recorder_->evicted(entry.label, entry.bytes);
  if (entry.holds_ > 0) return;
  entry.evicted_epoch_ = epoch_.fetch_add(1);
  limbo_.push_back(&entry);
}

// By a thread that is inside again: what it held and was evicted meanwhile waits for it as for any other.
void GeometryCache::release(CacheEntry& entry) {
  if (--entry.holds_ > 0 || !entry.evicted_) return;
  entry.evicted_epoch_ = epoch_.fetch_add(1);
  limbo_.push_back(&entry);
}

std::uint64_t GeometryCache::oldest_epoch() const {
  std::uint64_t oldest = outside;
  const int count = thread_indices.count();
  for (int i = 0; i < count; ++i) oldest = std::min(oldest, threads_[std::size_t(i)].epoch.load());
  return oldest;
}

// Takes out of limbo what no thread can use any more.
GeometryCache::Garbage GeometryCache::reclaim() {
  Garbage garbage;
  if (limbo_.empty()) return garbage;
  const std::uint64_t oldest = oldest_epoch();
  const auto first_kept =
      std::find_if(limbo_.begin(), limbo_.end(), [&](const CacheEntry* e) { return e->evicted_epoch_ >= oldest; });
  for (auto it = limbo_.begin(); it != first_kept; ++it) {
    statistics_.limbo_bytes -= (*it)->bytes;
    garbage.emplace_back(*it);
  }
  limbo_.erase(limbo_.begin(), first_kept);
  if (recorder_) recorder_->limbo_is(statistics_.limbo_bytes);
  return garbage;
}

bool GeometryCache::must_look_at_freed() {
  constexpr std::size_t least_bytes = std::size_t(16) << 20;
  if (evicted_bytes_ < look_at_freed_at_) return false;
  look_at_freed_at_ = evicted_bytes_ + std::max(budget_bytes_ / 2, least_bytes);
  return true;
}

// Where entries come and go malloc keeps gaps, and at the first eviction what the beginning needed. Mostly it uses them
// again, and what is given back for nothing is missed: all threads wait meanwhile, and all pages are looked up anew.
void GeometryCache::give_back_if_grown() {
  constexpr std::size_t least_bytes = std::size_t(8) << 20;
  const std::size_t slack = std::max(budget_bytes_ / 16, least_bytes), resident = resident_set_bytes();
  if (resident > 0 && resident < resident_set_.load(std::memory_order_relaxed) + slack) return;
  give_back_freed_memory();
  resident_set_.store(resident_set_bytes(), std::memory_order_relaxed);
}

CacheStatistics GeometryCache::statistics() const {
  const std::lock_guard lock(mutex_);
  CacheStatistics result = statistics_;
  result.waits = waits_.load(std::memory_order_relaxed);
  return result;
}

}  // namespace meristem
