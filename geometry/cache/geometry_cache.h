// GeometryCache: the cells that are expanded now, within a byte budget.
//
// A slot belongs to a proxy and leads to its entry. acquire() on a resident slot is one acquire load (and a store of
// the used bit if it is clear): no lock, no reference count, no hash. On an empty slot one thread expands (single
// flight); the others sleep until it is done. The expanding thread holds no lock while it works and waits for nobody.
//
// Eviction: CLOCK (second chance; its hit rate was within 0.1 points of LRU in a pilot), entries without resident
// children only, so parents leave after their children. Threads use entries inside a Visit (one ray); an evicted entry
// waits in limbo until every thread that was inside has left, so an entry that a ray in flight uses stays valid.
//
// The budget is a promise about all bytes: entries, limbo, and what the owner of the cache holds beside (other_bytes).
// It is exceeded by no more than the cells in flight: for each thread what it expands at the moment, and what it uses
// while it does: the cells around it (RayUse) and their ancestors. Two things keep limbo small. A thread that expands
// or waits is not inside, but holds what it uses by name, so it keeps nothing else from being freed. And before an
// expansion beyond the budget a thread waits until the rays of others have passed what has been evicted: microseconds,
// since whoever is inside only traces. So a thread inside must never wait for another; if one stays for `patience`
// nevertheless, the others go on without it.
//
// With a recorder, expansions, evictions and waits are recorded; hits never are.
//
// Threads: up to max_threads at once; more are a CHECK.
#pragma once

#include "geometry/base/key.h"

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace meristem {

class CacheEntry;
class ExpansionRecorder;

// The state of a proxy's cell in one word: Empty, Expanding, Failed, or Resident (a pointer to the entry).
class CacheSlot {
 public:
  enum class State : std::uint8_t { Empty, Expanding, Failed, Resident };
  State state() const;
  // Whether the cell had been expanded before (and evicted).
  bool was_expanded() const { return was_expanded_.load(std::memory_order_relaxed); }

 private:
  friend class GeometryCache;
  static constexpr std::uintptr_t empty = 0, expanding = 1, failed = 2;  // anything else: a CacheEntry*
  std::atomic<std::uintptr_t> word_{empty};
  std::atomic<bool> was_expanded_{false};  // written by the expanding thread only
};

// What a recorder knows an entry by.
struct CellLabel {
  Key cell = 0;                  // the same whenever the cell is expanded; 0: not known
  std::uint32_t cell_class = 0;  // ExpansionRecorder::class_of(); 0: none
  bool is_surface = false;
  std::size_t tree_bytes = 0;  // of its bytes: of hierarchies of boxes
};

// What an expansion left behind. Subclasses own the geometry; the destructor frees it.
class CacheEntry {
 public:
  virtual ~CacheEntry() = default;
  // Before it is destroyed because it was evicted: by a thread that holds no lock and is not inside.
  virtual void forgotten() {}
  // All memory of the entry, hidden costs included. Constant after construction.
  std::size_t bytes = 0;
  Key name = 0;  // for may_hold()
  CellLabel label;

 private:
  friend class GeometryCache;
  std::atomic<bool> used_{true};
  // Guarded by GeometryCache::mutex_.
  CacheSlot* slot_ = nullptr;
  CacheEntry* parent_ = nullptr;
  std::uint32_t children_ = 0;  // resident
  std::uint32_t holds_ = 0;     // by threads that use the entry while they expand or wait
  std::size_t clock_index_ = 0;
  bool evicted_ = false;
  std::uint64_t evicted_epoch_ = 0;
};

// What a ray in flight uses. The links lie on the stack of the thread that traces it.
struct UsedEntry {
  CacheEntry* entry;
  const UsedEntry* outer;
};
struct RayUse {
  const UsedEntry* cells = nullptr;  // that the ray is in, from the innermost on
  CacheEntry* nearest = nullptr;     // that holds its nearest hit so far
};

struct CacheStatistics {
  std::uint64_t expansions = 0, reexpansions = 0, evictions = 0, failures = 0, waits = 0;
  std::uint64_t overdrafts = 0;  // expansions beyond the budget because a thread stayed inside
  std::size_t resident_bytes = 0, resident_bytes_peak = 0, limbo_bytes = 0, limbo_bytes_peak = 0;
  std::size_t total_bytes_peak = 0;  // resident, in limbo and beside the cache
};

class GeometryCache {
 public:
  static constexpr int max_threads = 1088;  // the most that --threads allows, and some

  static constexpr std::chrono::milliseconds patience{100};

  // `other_bytes` tells what else of the budget is taken at the moment; asked at every expansion. A recorder outlives
  // the cache.
  explicit GeometryCache(std::size_t budget_bytes, ExpansionRecorder* recorder = nullptr,
                         std::function<std::size_t()> other_bytes = {})
      : budget_bytes_(budget_bytes), other_bytes_(std::move(other_bytes)), recorder_(recorder) {}
  ~GeometryCache();
  GeometryCache(const GeometryCache&) = delete;
  GeometryCache& operator=(const GeometryCache&) = delete;

  // The slot's entry, made by `expand` if it is not resident; nullptr if expansion failed (expand threw; not tried
  // again). `parent` is the entry that holds the slot, nullptr for a root. The entry stays valid until the end of the
  // caller's Visit or its next acquire(), whichever is first; what `use` names, through every acquire() that names it.
  template <class Expand>
  CacheEntry* acquire(CacheSlot& slot, CacheEntry* parent, const RayUse& use, Expand&& expand) {
    if (CacheEntry* entry = find(slot)) [[likely]]
      return entry;
    return acquire_slow(slot, parent, use, expand);
  }

  // The slot's entry if it is resident, nullptr if not; expands nothing. Valid as what acquire() returns.
  CacheEntry* find(CacheSlot& slot) {
    const std::uintptr_t word = slot.word_.load();
    if (word <= CacheSlot::failed) return nullptr;
    auto* entry = reinterpret_cast<CacheEntry*>(word);
    if (!entry->used_.load(std::memory_order_relaxed)) entry->used_.store(true, std::memory_order_relaxed);
    return entry;
  }

  // Whether an entry of that name may be resident; mostly not, if not. One load.
  bool may_hold(Key name) const { return names_[name % name_buckets].load(std::memory_order_relaxed) > 0; }

  // While one lives, its thread is inside and may use entries. Not nested.
  class Visit {
   public:
    explicit Visit(GeometryCache& cache) : cache_(cache), mine_(cache.threads_[std::size_t(thread_index())].epoch) {
      cache_.enter(mine_);
    }
    ~Visit() { mine_.store(outside, std::memory_order_release); }
    Visit(const Visit&) = delete;
    Visit& operator=(const Visit&) = delete;

   private:
    GeometryCache& cache_;
    std::atomic<std::uint64_t>& mine_;
  };

  // What is resident now stays until release_kept(). Not while threads trace.
  void keep_resident();
  void release_kept();
  // Whether the budget has been too small since for more than what is kept.
  bool is_crowded() const { return is_crowded_.load(std::memory_order_relaxed); }

  std::size_t budget_bytes() const { return budget_bytes_; }
  CacheStatistics statistics() const;
  // What the calling thread expanded so far, in its life and that of threads that had its index before.
  struct ThreadCounts {
    std::uint64_t expansions = 0, reexpansions = 0, acquired = 0;
    std::uint64_t nanoseconds = 0;  // in which it expanded, or waited for another thread to
  };
  // Hits are counted by whoever acquires, once a ray.
  void count_acquired(std::uint64_t n) { threads_[std::size_t(thread_index())].counts.acquired += n; }
  ThreadCounts thread_counts() const { return threads_[std::size_t(thread_index())].counts; }
  // Of the calling thread for its life, in all caches; given to another thread after it.
  static int thread_index();

 private:
  using Expand = std::function<std::unique_ptr<CacheEntry>()>;
  struct Forget {
    void operator()(CacheEntry* entry) const {
      entry->forgotten();
      delete entry;
    }
  };
  using Garbage = std::vector<std::unique_ptr<CacheEntry, Forget>>;  // to be destroyed when mutex_ is not held
  class Absence;
  void enter(std::atomic<std::uint64_t>& mine) {
    mine.store(epoch_.load());  // sequentially consistent, as the loads of slots and what evict() does: it sees this
                                // thread inside, or this thread sees the slot empty
  }
  CacheEntry* acquire_slow(CacheSlot& slot, CacheEntry* parent, const RayUse& use, const Expand& expand);
  void wait_for(const CacheSlot& slot);
  CacheEntry* expand_slot(CacheSlot& slot, CacheEntry* parent, Absence& absence, const Expand& expand);
  void make_room();
  void publish(CacheSlot& slot, CacheEntry* parent, Absence& absence, std::unique_ptr<CacheEntry> entry);
  void publish_failure(CacheSlot& slot);
  void give_back_if_grown();
  // All below need mutex_.
  void add_resident(CacheSlot& slot, CacheEntry* parent, CacheEntry* entry);
  void evict_to_budget();
  void evict(CacheEntry& entry);
  void add_to_limbo(CacheEntry& entry);
  void release(CacheEntry& entry);
  Garbage reclaim();
  bool must_look_at_freed();
  std::size_t entry_budget() const;
  void note_peaks();
  std::uint64_t oldest_epoch() const;

  static constexpr std::uint64_t outside = ~std::uint64_t(0);
  struct alignas(64) ThreadEpoch {
    std::atomic<std::uint64_t> epoch{outside};
    ThreadCounts counts;  // touched by the thread alone
  };

  const std::size_t budget_bytes_;
  const std::function<std::size_t()> other_bytes_;
  ExpansionRecorder* const recorder_;
  std::array<ThreadEpoch, max_threads> threads_;
  std::atomic<std::uint64_t> epoch_{1};
  std::atomic<std::uint64_t> waits_{0};
  std::atomic<bool> is_crowded_{false};
  std::atomic<std::size_t> resident_set_{0};  // of the process, when freed memory was given back last
  static constexpr std::size_t name_buckets = 1 << 15;
  std::vector<std::atomic<std::uint32_t>> names_ =  // of resident entries, by bucket; written under mutex_
      std::vector<std::atomic<std::uint32_t>>(name_buckets);

  mutable std::mutex mutex_;
  std::vector<CacheEntry*> clock_;  // resident entries; owned
  std::size_t kept_ = 0;            // the first of them stay
  std::size_t hand_ = 0;
  std::uint64_t evicted_bytes_ = 0, look_at_freed_at_ = 1;
  std::vector<CacheEntry*> limbo_;  // evicted and not held, by evicted_epoch_; owned
  CacheStatistics statistics_;
};

}  // namespace meristem
