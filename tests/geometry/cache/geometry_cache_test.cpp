#include "geometry/cache/geometry_cache.h"

#include "geometry/base/key.h"
#include "geometry/base/parallel.h"

#include <gtest/gtest.h>

#include <barrier>
#include <stdexcept>
#include <thread>

namespace meristem {
namespace {

// What a test sees of one entry from outside, before and after its end.
struct Trace {
  std::atomic<int> expanded{0}, destroyed{0};
  bool is_alive() const { return expanded.load() > destroyed.load(); }
};

class TracedEntry : public CacheEntry {
 public:
  TracedEntry(Trace& trace, std::size_t size, std::size_t children = 0)
      : slots(children), trace_(trace), is_valid_(true) {
    bytes = size;
    ++trace_.expanded;
  }
  ~TracedEntry() override {
    is_valid_ = false;
    ++trace_.destroyed;
  }
  // Reads the entry's memory: a sanitizer sees it if the entry is gone.
  bool is_valid() const { return is_valid_; }

  std::vector<CacheSlot> slots;  // of its children

 private:
  Trace& trace_;
  volatile bool is_valid_;
};

// Slots without a parent, each with an entry of 100 bytes.
class FlatCache {
 public:
  FlatCache(std::size_t entries, std::size_t budget_bytes) : traces_(entries), slots_(entries), cache(budget_bytes) {}

  TracedEntry* acquire(std::size_t i, const RayUse& use = {}) {
    return static_cast<TracedEntry*>(
        cache.acquire(slots_[i], nullptr, use, [this, i] { return std::make_unique<TracedEntry>(traces_[i], 100); }));
  }
  // Uses entries as a ray does.
  void use(std::initializer_list<std::size_t> entries) {
    const GeometryCache::Visit visit(cache);
    for (std::size_t i : entries) acquire(i);
  }
  bool is_resident(std::size_t i) const { return slots_[i].state() == CacheSlot::State::Resident; }
  const Trace& trace(std::size_t i) const { return traces_[i]; }
  CacheSlot& slot(std::size_t i) { return slots_[i]; }

 private:
  std::vector<Trace> traces_;  // outlives the entries, as in every test here
  std::vector<CacheSlot> slots_;

 public:
  GeometryCache cache;
};

TEST(GeometryCache, ExpandsOnceAndThenFindsTheEntry) {
  FlatCache f(1, 1000);
  EXPECT_EQ(f.slot(0).state(), CacheSlot::State::Empty);
  EXPECT_FALSE(f.slot(0).was_expanded());
  TracedEntry* entry = f.acquire(0);
  EXPECT_EQ(f.slot(0).state(), CacheSlot::State::Resident);
  EXPECT_TRUE(f.slot(0).was_expanded());
  for (int i = 0; i < 10; ++i) EXPECT_EQ(f.acquire(0), entry);
  EXPECT_EQ(f.trace(0).expanded, 1);
  EXPECT_EQ(f.cache.statistics().expansions, 1u);
  EXPECT_EQ(f.cache.statistics().resident_bytes, 100u);
}

TEST(GeometryCache, ManyThreadsExpandASlotOnce) {
  FlatCache f(64, std::size_t(1) << 40);
  std::barrier together(8);
  run_threads(8, [&](int) {
    for (std::size_t i = 0; i < 64; ++i) {
      together.arrive_and_wait();
      const GeometryCache::Visit visit(f.cache);
      const TracedEntry* entry = f.acquire(i);
      EXPECT_TRUE(entry && entry->is_valid());
    }
  });
  for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(f.trace(i).expanded, 1) << i;
  EXPECT_EQ(f.cache.statistics().expansions, 64u);
}

TEST(GeometryCache, OthersWaitForTheThreadThatExpands) {
  Trace trace;
  CacheSlot slot;
  GeometryCache cache(1000);
  std::atomic<int> found{0};
  run_threads(3, [&](int) {
    const GeometryCache::Visit visit(cache);
    found += cache.acquire(slot, nullptr, {}, [&]() -> std::unique_ptr<CacheEntry> {
      while (cache.statistics().waits < 2) std::this_thread::yield();  // both others have come
      return std::make_unique<TracedEntry>(trace, 1);
    }) != nullptr;
  });
  EXPECT_EQ(found, 3);
  EXPECT_EQ(trace.expanded, 1);
  EXPECT_EQ(cache.statistics().waits, 2u);
}

TEST(GeometryCache, KnowsHowLongAThreadWaitedForCells) {
  Trace trace;
  CacheSlot slot;
  GeometryCache cache(1000);
  std::atomic<std::uint64_t> nanoseconds{0};
  constexpr std::chrono::milliseconds once_all_wait{2};
  run_threads(2, [&](int) {
    const GeometryCache::Visit visit(cache);
    cache.acquire(slot, nullptr, {}, [&]() -> std::unique_ptr<CacheEntry> {
      while (cache.statistics().waits < 1) std::this_thread::yield();
      std::this_thread::sleep_for(once_all_wait);
      return std::make_unique<TracedEntry>(trace, 1);
    });
    const std::uint64_t waited = cache.thread_counts().nanoseconds;
    cache.acquire(slot, nullptr, {}, [] { return nullptr; });  // resident
    EXPECT_EQ(cache.thread_counts().nanoseconds, waited);
    nanoseconds += waited;
  });
  EXPECT_GE(nanoseconds, std::uint64_t(std::chrono::nanoseconds(2 * once_all_wait).count()))
      << "by the one that expanded and by the one that waited for it";
}

TEST(GeometryCache, KeepsToItsBudget) {
  FlatCache f(50, 1000);
  for (std::size_t i = 0; i < 50; ++i) {
    f.use({i});
    EXPECT_TRUE(f.is_resident(i));
    EXPECT_EQ(f.cache.statistics().resident_bytes, 100 * std::min<std::size_t>(i + 1, 10));
  }
  const CacheStatistics s = f.cache.statistics();
  EXPECT_EQ(s.resident_bytes_peak, 1000u);
  EXPECT_EQ(s.expansions, 50u);
  EXPECT_EQ(s.evictions, 40u);
  EXPECT_EQ(s.reexpansions, 0u);
  f.use({0});
  EXPECT_EQ(f.cache.statistics().reexpansions, 1u);
}

TEST(GeometryCache, AnEntryLargerThanTheBudgetStaysForItsUser) {
  Trace trace;
  CacheSlot large, small;
  GeometryCache cache(10);
  const auto make = [&] { return std::make_unique<TracedEntry>(trace, 100); };
  {
    const GeometryCache::Visit visit(cache);
    EXPECT_NE(cache.acquire(large, nullptr, {}, make), nullptr);
    EXPECT_EQ(large.state(), CacheSlot::State::Resident);
  }
  cache.acquire(small, nullptr, {}, make);
  cache.acquire(large, nullptr, {}, make);  // the used bits of both had been cleared by then
  EXPECT_EQ(cache.statistics().resident_bytes, 100u);
}

TEST(GeometryCache, EvictionGivesASecondChance) {
  FlatCache f(6, 300);
  f.use({0, 1, 2});
  f.use({3});  // all were used: the first round clears the bits, the second takes 0
  EXPECT_FALSE(f.is_resident(0));
  f.use({1});  // used again since
  f.use({4});
  EXPECT_TRUE(f.is_resident(1));
  EXPECT_FALSE(f.is_resident(2));
  f.use({1});
  f.use({5});
  EXPECT_TRUE(f.is_resident(1));
  EXPECT_EQ(f.trace(1).expanded, 1);
}

TEST(GeometryCache, WhatIsKeptStaysAndTheOthersShareTheRest) {
  FlatCache flat(10, 500);
  flat.use({0, 1, 2});
  EXPECT_FALSE(flat.cache.is_crowded());
  flat.cache.keep_resident();
  flat.use({3, 4});
  EXPECT_FALSE(flat.cache.is_crowded());
  for (std::size_t i : {5, 6, 7, 8, 9}) flat.use({i});
  EXPECT_TRUE(flat.cache.is_crowded());
  for (std::size_t i : {0, 1, 2}) EXPECT_TRUE(flat.is_resident(i)) << i;
  EXPECT_LE(flat.cache.statistics().resident_bytes, 500u);
  flat.cache.release_kept();
  EXPECT_FALSE(flat.cache.is_crowded());
  for (std::size_t i : {3, 4, 5, 6, 7, 8, 9, 3, 4, 5, 6, 7, 8, 9}) flat.use({i});
  for (std::size_t i : {0, 1, 2}) EXPECT_FALSE(flat.is_resident(i)) << i;
  EXPECT_FALSE(flat.cache.is_crowded()) << "nothing is kept";
}

TEST(GeometryCache, ParentsLeaveAfterTheirChildren) {
  Trace parent_trace, child_traces[2], other_trace;
  CacheSlot root, others[3];
  GeometryCache cache(250);
  auto* parent = static_cast<TracedEntry*>(
      cache.acquire(root, nullptr, {}, [&] { return std::make_unique<TracedEntry>(parent_trace, 50, 2); }));
  for (std::size_t i = 0; i < 2; ++i)
    cache.acquire(parent->slots[i], parent, {}, [&] { return std::make_unique<TracedEntry>(child_traces[i], 100); });
  const auto acquire_other = [&](int i) {
    cache.acquire(others[i], nullptr, {}, [&] { return std::make_unique<TracedEntry>(other_trace, 100); });
  };
  acquire_other(0);  // the oldest is the parent, but a child has to go
  EXPECT_EQ(root.state(), CacheSlot::State::Resident);
  EXPECT_EQ(child_traces[0].destroyed + child_traces[1].destroyed, 1);
  acquire_other(1);
  EXPECT_EQ(root.state(), CacheSlot::State::Resident);
  EXPECT_FALSE(child_traces[0].is_alive() || child_traces[1].is_alive());
  acquire_other(2);  // without children it goes as any other
  EXPECT_TRUE(parent_trace.is_alive() == (root.state() == CacheSlot::State::Resident));
  EXPECT_LE(cache.statistics().resident_bytes, 250u);
}

TEST(GeometryCache, AncestorsOfTheNewestEntryStayBeyondTheBudget) {
  Trace traces[3];
  CacheSlot root;
  GeometryCache cache(1);
  TracedEntry* entry = nullptr;
  for (Trace& trace : traces)
    entry = static_cast<TracedEntry*>(cache.acquire(entry ? entry->slots[0] : root, entry, {},
                                                    [&] { return std::make_unique<TracedEntry>(trace, 100, 1); }));
  for (const Trace& trace : traces) EXPECT_TRUE(trace.is_alive());
  EXPECT_EQ(cache.statistics().resident_bytes, 300u);
}

TEST(GeometryCache, WhatARayUsesOutlivesItsEviction) {
  FlatCache f(8, 100);
  std::barrier step(2);
  run_threads(2, [&](int thread) {
    if (thread == 0) {
      {
        const GeometryCache::Visit visit(f.cache);
        const TracedEntry* used = f.acquire(0);
        step.arrive_and_wait();  // the other evicts it
        step.arrive_and_wait();
        EXPECT_FALSE(f.is_resident(0));
        EXPECT_TRUE(f.trace(0).is_alive());
        EXPECT_TRUE(used->is_valid());
      }
      step.arrive_and_wait();
    } else {
      step.arrive_and_wait();
      f.use({1, 2});
      EXPECT_GE(f.cache.statistics().limbo_bytes, 100u);
      EXPECT_EQ(f.cache.statistics().overdrafts, 1u) << "2 had to wait for what 1 had evicted, in vain";
      step.arrive_and_wait();
      step.arrive_and_wait();  // the user has left
      f.use({4});
      EXPECT_FALSE(f.trace(0).is_alive());
    }
  });
  EXPECT_EQ(f.cache.statistics().limbo_bytes, 0u);
}

// A ray that goes on and on keeps what it is in and its nearest hit, and nothing else of what it has met.
TEST(GeometryCache, ARayKeepsWhatItNamesAlone) {
  FlatCache f(40, 100);
  const GeometryCache::Visit visit(f.cache);
  TracedEntry* const cell = f.acquire(0);
  const UsedEntry in_cell{cell, nullptr};
  RayUse use{&in_cell, nullptr};
  TracedEntry* const hit = f.acquire(1, use);
  use.nearest = hit;
  for (std::size_t i = 2; i < 40; ++i) {
    EXPECT_TRUE(f.acquire(i, use)->is_valid());
    EXPECT_TRUE(cell->is_valid() && hit->is_valid());
    EXPECT_LE(f.cache.statistics().resident_bytes + f.cache.statistics().limbo_bytes, 400u);
  }
  for (std::size_t i = 2; i < 38; ++i) EXPECT_FALSE(f.trace(i).is_alive()) << i;
  EXPECT_EQ(f.cache.statistics().overdrafts, 0u);
}

// What is evicted while it is held by name waits for the ray that names it once more.
TEST(GeometryCache, WhatWasEvictedMeanwhileStaysForTheRayThatNamesIt) {
  FlatCache f(8, 100);
  std::barrier step(2);
  run_threads(2, [&](int thread) {
    if (thread == 1) {
      step.arrive_and_wait();
      f.use({1});  // evicts 0, which the ray in flight uses
      EXPECT_FALSE(f.is_resident(0));
      step.arrive_and_wait();
      return;
    }
    const GeometryCache::Visit visit(f.cache);
    TracedEntry* const used = f.acquire(0);
    step.arrive_and_wait();
    step.arrive_and_wait();
    const UsedEntry in_cell{used, nullptr};
    for (std::size_t i = 2; i < 8; ++i) {
      f.acquire(i, {&in_cell, nullptr});
      EXPECT_TRUE(used->is_valid());
    }
  });
  f.use({7, 1});
  EXPECT_FALSE(f.trace(0).is_alive());
}

TEST(GeometryCache, AChildOfAnEvictedParentIsUsedOnceAndThrownAway) {
  Trace parent_trace, child_trace, other_trace;
  CacheSlot root, other;
  GeometryCache cache(100);
  std::barrier step(2);
  run_threads(2, [&](int thread) {
    const GeometryCache::Visit visit(cache);
    if (thread == 1) {
      step.arrive_and_wait();
      cache.acquire(other, nullptr, {}, [&] { return std::make_unique<TracedEntry>(other_trace, 100); });
      step.arrive_and_wait();
      return;
    }
    auto* parent = static_cast<TracedEntry*>(
        cache.acquire(root, nullptr, {}, [&] { return std::make_unique<TracedEntry>(parent_trace, 100, 1); }));
    step.arrive_and_wait();
    step.arrive_and_wait();
    ASSERT_EQ(root.state(), CacheSlot::State::Empty);
    ASSERT_TRUE(parent->is_valid());
    auto* child = static_cast<TracedEntry*>(
        cache.acquire(parent->slots[0], parent, {}, [&] { return std::make_unique<TracedEntry>(child_trace, 100); }));
    EXPECT_TRUE(child->is_valid());
    EXPECT_EQ(parent->slots[0].state(), CacheSlot::State::Empty);
    EXPECT_EQ(cache.statistics().limbo_bytes, 200u);
  });
  cache.acquire(root, nullptr, {}, [&] { return std::make_unique<TracedEntry>(other_trace, 100, 1); });
  EXPECT_FALSE(parent_trace.is_alive() || child_trace.is_alive());
}

TEST(GeometryCache, WhatIsHeldBesideItCountsAgainstTheBudget) {
  Trace trace;
  CacheSlot slots[8];
  std::size_t others = 0;
  GeometryCache cache(500, nullptr, [&] { return others; });
  const auto use = [&](int i) {
    const GeometryCache::Visit visit(cache);
    cache.acquire(slots[i], nullptr, {}, [&] { return std::make_unique<TracedEntry>(trace, 100); });
  };
  for (int i = 0; i < 5; ++i) use(i);
  EXPECT_EQ(cache.statistics().resident_bytes, 500u);
  others = 300;
  use(5);
  EXPECT_EQ(cache.statistics().resident_bytes, 200u);
  EXPECT_EQ(cache.statistics().total_bytes_peak, 600u) << "one beyond the budget: what went for the sixth";
}

TEST(GeometryCache, AFailureIsRememberedAndReachesAllWhoWait) {
  CacheSlot slot;
  GeometryCache cache(1000);
  std::atomic<int> tries{0}, found{0};
  run_threads(8, [&](int) {
    for (int i = 0; i < 10; ++i) {
      const GeometryCache::Visit visit(cache);
      found += cache.acquire(slot, nullptr, {}, [&]() -> std::unique_ptr<CacheEntry> {
        ++tries;
        throw std::runtime_error("on purpose");
      }) != nullptr;
    }
  });
  EXPECT_EQ(tries, 1);
  EXPECT_EQ(found, 0);
  EXPECT_EQ(slot.state(), CacheSlot::State::Failed);
  EXPECT_EQ(cache.statistics().failures, 1u);
  EXPECT_EQ(cache.statistics().expansions, 0u);
}

TEST(GeometryCache, AFailedChildDoesNotHoldItsParent) {
  Trace parent_trace, other_trace;
  CacheSlot root, other;
  GeometryCache cache(100);
  auto* parent = static_cast<TracedEntry*>(
      cache.acquire(root, nullptr, {}, [&] { return std::make_unique<TracedEntry>(parent_trace, 100, 1); }));
  const auto fail = []() -> std::unique_ptr<CacheEntry> { throw std::runtime_error("on purpose"); };
  EXPECT_EQ(cache.acquire(parent->slots[0], parent, {}, fail), nullptr);
  cache.acquire(other, nullptr, {}, [&] { return std::make_unique<TracedEntry>(other_trace, 100); });
  EXPECT_FALSE(parent_trace.is_alive());
}

TEST(GeometryCache, ThreadsThatComeAndGoShareNoIndex) {
  FlatCache f(8, 100);
  f.use({0});
  for (int i = 0; i < 2 * GeometryCache::max_threads; ++i) std::jthread([&] { f.use({1, 2}); });
  EXPECT_FALSE(f.trace(0).is_alive());
}

TEST(GeometryCache, DestroysWhatItHolds) {
  Trace trace;
  CacheSlot slots[3];
  {
    GeometryCache cache(250);
    const GeometryCache::Visit visit(cache);
    for (CacheSlot& slot : slots)
      cache.acquire(slot, nullptr, {}, [&] { return std::make_unique<TracedEntry>(trace, 100); });
    EXPECT_EQ(trace.destroyed, 1);
  }
  EXPECT_EQ(trace.expanded, 3);
  EXPECT_EQ(trace.destroyed, 3);
}

// A tree of entries of 100 bytes, walked by paths that a hash chooses.
class Tree {
 public:
  Tree(Trace& t, std::size_t depth, std::size_t branching, std::size_t budget_bytes)
      : trace(t), depth_(depth), branching_(branching), cache(budget_bytes) {}

  void walk(Key path) {
    CacheSlot* slot = &root_;
    TracedEntry* entry = nullptr;
    std::vector<UsedEntry> used(depth_);
    RayUse use;
    for (std::size_t level = 0; level < depth_; ++level) {
      entry = static_cast<TracedEntry*>(cache.acquire(*slot, entry, use, [&] {
        return std::make_unique<TracedEntry>(trace, 100, level + 1 < depth_ ? branching_ : 0);
      }));
      ASSERT_TRUE(entry && entry->is_valid());
      used[level] = {entry, use.cells};
      use.cells = &used[level];
      if (!entry->slots.empty()) slot = &entry->slots[hash_keys(path, level) % branching_];
    }
    for (const UsedEntry& u : used) ASSERT_TRUE(static_cast<TracedEntry*>(u.entry)->is_valid());
  }

  Trace& trace;

 private:
  const std::size_t depth_, branching_;
  CacheSlot root_;

 public:
  GeometryCache cache;
};

// `walks` of every thread, two paths a ray.
void walk_tree(int threads, std::size_t depth, std::size_t branching, std::size_t budget, int walks) {
  Trace trace;
  {
    Tree tree(trace, depth, branching, budget);
    run_threads(threads, [&](int thread) {
      for (int i = 0; i < walks; ++i) {
        const GeometryCache::Visit visit(tree.cache);
        tree.walk(hash_keys(Key(thread), Key(i)));
        tree.walk(hash_keys(Key(thread), Key(i), 1));
      }
    });
    const CacheStatistics s = tree.cache.statistics();
    EXPECT_EQ(s.expansions, std::uint64_t(trace.expanded.load()));
    EXPECT_GT(s.evictions, 100u);
    EXPECT_EQ(s.failures, 0u);
    // Beyond the budget at most the cells in flight: of each thread the newest, its ancestors, and what went for it
    // (unless the machine left a thread alone inside for too long)
    EXPECT_TRUE(s.overdrafts > 0 || s.total_bytes_peak <= budget + std::size_t(threads) * (depth + 1) * 100)
        << s.total_bytes_peak << " bytes in a budget of " << budget;
    EXPECT_LE(s.overdrafts, 3u);
    EXPECT_EQ((s.resident_bytes + s.limbo_bytes) / 100, std::uint64_t(trace.expanded - trace.destroyed));
  }
  EXPECT_EQ(trace.expanded, trace.destroyed);
}

TEST(GeometryCache, ManyThreadsInATinyBudget) {
  for (std::size_t budget : {std::size_t(100), std::size_t(600), std::size_t(1200)}) walk_tree(8, 3, 8, budget, 2000);
}

// Some 10^5 expansions.
TEST(GeometryCache, ManyThreadsInABudgetOfOneEntryEach) { walk_tree(16, 8, 4, 16 * 100, 1500); }

}  // namespace
}  // namespace meristem
