// GeometryCache: the cells that are expanded now, within a byte budget.
//
// A slot belongs to a proxy and leads to its entry. acquire() on a resident slot is one acquire load (and a store of
// the used bit if it is clear): no lock, no reference count, no hash. On an empty slot one thread expands (single
// flight); the others sleep until it is done. The expanding thread holds no lock while it works and waits for nobody.
//
// Eviction: CLOCK (second chance; its hit rate was within 0.1 points of LRU in a pilot), entries without resident
// children only, so parents leave after their children. Threads use entries between enter() and leave() (one camera
// path); an evicted entry waits in limbo until every thread that was inside has left, so an entry that a ray in flight
// uses stays valid. Resident bytes exceed the budget by no more than the cells being expanded at the moment; what
// cannot be evicted (ancestors of cells in use) stays.
//
// With a recorder, expansions, evictions and waits are recorded; hits never are.
//
// Threads: up to max_threads at once; more are a CHECK.
#pragma once

#include "geometry/base/key.h"

#include <array>
#include <atomic>
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
  bool was_expanded() const { return was_expanded_; }

 private:
  friend class GeometryCache;
  static constexpr std::uintptr_t empty = 0, expanding = 1, failed = 2;  // anything else: a CacheEntry*
  std::atomic<std::uintptr_t> word_{empty};
  bool was_expanded_ = false;  // written by the expanding thread only
};

// What a recorder knows an entry by.
struct CellLabel {
  Key cell = 0;                  // the same whenever the cell is expanded; 0: not known
  std::uint32_t cell_class = 0;  // ExpansionRecorder::class_of(); 0: none
  bool is_surface = false;
  std::size_t tree_bytes = 0;  // of its bytes: Embree's
};

// What an expansion left behind. Subclasses own the geometry; the destructor frees it.
class CacheEntry {
 public:
  virtual ~CacheEntry() = default;
  // All memory of the entry, hidden costs included. Constant after construction.
  std::size_t bytes = 0;
  CellLabel label;

 private:
  friend class GeometryCache;
  std::atomic<bool> used_{true};
  // Guarded by GeometryCache::mutex_.
  CacheSlot* slot_ = nullptr;
  CacheEntry* parent_ = nullptr;
  std::uint32_t children_ = 0;  // resident or being expanded
  std::size_t clock_index_ = 0;
  bool evicted_ = false;
  std::uint64_t evicted_epoch_ = 0;
};

struct CacheStatistics {
  std::uint64_t expansions = 0, reexpansions = 0, evictions = 0, failures = 0, waits = 0;
  std::size_t resident_bytes = 0, resident_bytes_peak = 0, limbo_bytes = 0, limbo_bytes_peak = 0;
};

class GeometryCache {
 public:
  static constexpr int max_threads = 1088;  // the most that --threads allows, and some

  // A recorder outlives the cache.
  explicit GeometryCache(std::size_t budget_bytes, ExpansionRecorder* recorder = nullptr)
      : budget_bytes_(budget_bytes), recorder_(recorder) {}
  ~GeometryCache();
  GeometryCache(const GeometryCache&) = delete;
  GeometryCache& operator=(const GeometryCache&) = delete;

  // The slot's entry, made by `expand` if it is not resident; nullptr if expansion failed (expand threw; not tried
  // again). `parent` is the entry that holds the slot, nullptr for a root. The entry stays valid until the caller's
  // leave().
  template <class Expand>
  CacheEntry* acquire(CacheSlot& slot, CacheEntry* parent, Expand&& expand) {
    const std::uintptr_t word = slot.word_.load();
    if (word > CacheSlot::failed) [[likely]] {
      auto* entry = reinterpret_cast<CacheEntry*>(word);
      if (!entry->used_.load(std::memory_order_relaxed)) entry->used_.store(true, std::memory_order_relaxed);
      return entry;
    }
    return acquire_slow(slot, parent, expand);
  }

  // The calling thread begins to use entries. Cheap if it is inside already.
  void enter() {
    std::atomic<std::uint64_t>& mine = threads_[std::size_t(thread_index())].epoch;
    if (mine.load(std::memory_order_relaxed) != outside) return;
    mine.store(epoch_.load());  // sequentially consistent, as the loads of slots and what evict() does: it sees this
                                // thread inside, or this thread sees the slot empty
  }
  // The calling thread holds no entry any more.
  void leave() { threads_[std::size_t(thread_index())].epoch.store(outside, std::memory_order_release); }

  std::size_t budget_bytes() const { return budget_bytes_; }
  CacheStatistics statistics() const;
  // What the calling thread expanded so far, in its life and that of threads that had its index before.
  struct ThreadCounts {
    std::uint64_t expansions = 0, reexpansions = 0;
  };
  ThreadCounts thread_counts() const { return threads_[std::size_t(thread_index())].counts; }
  // Of the calling thread for its life, in all caches; given to another thread after it.
  static int thread_index();

 private:
  using Expand = std::function<std::unique_ptr<CacheEntry>()>;
  CacheEntry* acquire_slow(CacheSlot& slot, CacheEntry* parent, const Expand& expand);
  void wait_for(const CacheSlot& slot);
  CacheEntry* expand_slot(CacheSlot& slot, CacheEntry* parent, const Expand& expand);
  bool adopt_child(CacheEntry* parent);                                                                  // takes mutex_
  void publish(CacheSlot& slot, CacheEntry* parent, std::unique_ptr<CacheEntry> entry, bool is_orphan);  // takes mutex_
  void publish_failure(CacheSlot& slot, CacheEntry* parent, bool is_orphan);
  // All below need mutex_.
  void evict_to_budget(const CacheEntry* keep);
  void evict(CacheEntry& entry);
  void send_to_limbo(CacheEntry* entry);
  void reclaim();
  std::uint64_t oldest_epoch() const;

  static constexpr std::uint64_t outside = ~std::uint64_t(0);
  struct alignas(64) ThreadEpoch {
    std::atomic<std::uint64_t> epoch{outside};
    ThreadCounts counts;  // touched by the thread alone
  };

  const std::size_t budget_bytes_;
  ExpansionRecorder* const recorder_;
  std::array<ThreadEpoch, max_threads> threads_;
  std::atomic<std::uint64_t> epoch_{1};
  std::atomic<std::uint64_t> waits_{0};

  mutable std::mutex mutex_;
  std::vector<CacheEntry*> clock_;  // resident entries; owned
  std::size_t hand_ = 0;
  std::vector<CacheEntry*> limbo_;  // owned
  CacheStatistics statistics_;
};

}  // namespace meristem
