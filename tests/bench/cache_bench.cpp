// The geometry cache by itself: the hit path in nanoseconds, and stress: 16 threads that acquire, expand and evict
// entries nested 8 deep in a budget of one entry a thread. Prints the longest time one ray took (stalls), and checks
// that nothing is left at the end.
//
//   bench_cache [EXPANSIONS] [THREADS]
#include "geometry/base/parallel.h"
#include "geometry/cache/geometry_cache.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>

using namespace meristem;

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

std::atomic<std::int64_t> live_entries{0};

class Entry : public CacheEntry {
 public:
  explicit Entry(std::size_t children) : slots(children) {
    bytes = 1000;
    ++live_entries;
  }
  ~Entry() override { --live_entries; }
  std::vector<CacheSlot> slots;
};

void measure_hits() {
  constexpr std::size_t entries = 1024, rounds = 20000;
  GeometryCache cache(std::size_t(1) << 40);
  std::vector<CacheSlot> slots(entries);
  const auto acquire = [&](std::size_t i) {
    return cache.acquire(slots[i], nullptr, {}, [] { return std::make_unique<Entry>(0); });
  };
  for (std::size_t i = 0; i < entries; ++i) acquire(i);
  std::size_t sum = 0;
  const std::clock_t start = std::clock();
  for (std::size_t round = 0; round < rounds; ++round) {
    const GeometryCache::Visit visit(cache);
    for (std::size_t i = 0; i < entries; ++i) sum += acquire(i * 389 % entries)->bytes;  // 389: in no order
  }
  const double hit_s = double(std::clock() - start) / CLOCKS_PER_SEC / double(rounds * entries);
  const std::clock_t visits_start = std::clock();
  constexpr std::size_t visits = 10000000;
  for (std::size_t i = 0; i < visits; ++i) {
    const GeometryCache::Visit visit(cache);
    sum += acquire(i % entries)->bytes;
  }
  const double visit_s = double(std::clock() - visits_start) / CLOCKS_PER_SEC / visits;
  std::printf("a hit: %.2f ns; a visit of one hit: %.2f ns (%zu)\n", 1e9 * hit_s, 1e9 * visit_s, sum % 10);
}

constexpr std::size_t nesting = 8, branching = 4;

// Down a tree of cells by a path that a key chooses, as the callbacks of a ray go.
bool walk(GeometryCache& cache, CacheSlot& root, Key path) {
  const GeometryCache::Visit visit(cache);
  std::array<UsedEntry, nesting> used{};
  RayUse use;
  CacheSlot* slot = &root;
  CacheEntry* parent = nullptr;
  for (std::size_t level = 0; level < nesting; ++level) {
    auto* entry = static_cast<Entry*>(cache.acquire(
        *slot, parent, use, [&] { return std::make_unique<Entry>(level + 1 < nesting ? branching : 0); }));
    if (!entry) return false;
    used[level] = {entry, use.cells};
    use.cells = &used[level];
    parent = entry;
    if (level + 1 < nesting) slot = &entry->slots[hash_keys(path, level) % branching];
  }
  return true;
}

int stress(std::uint64_t expansions, int threads) {
  CacheSlot root;
  double longest = 0;
  CacheStatistics s;
  std::atomic<bool> failed{false};
  const auto start = Clock::now();
  {
    GeometryCache cache(std::size_t(threads) * 1000);
    std::vector<double> longest_of(std::size_t(threads), 0.0);
    run_threads(threads, [&](int thread) {
      const std::uint64_t mine = expansions / std::uint64_t(threads);
      const std::uint64_t before = cache.thread_counts().expansions;
      for (std::uint64_t i = 0; cache.thread_counts().expansions - before < mine; ++i) {
        const auto ray_start = Clock::now();
        if (!walk(cache, root, hash_keys(Key(thread), i))) failed = true;
        longest_of[std::size_t(thread)] = std::max(longest_of[std::size_t(thread)], seconds_since(ray_start));
      }
    });
    longest = std::ranges::max(longest_of);
    s = cache.statistics();
  }
  std::printf(
      "stress: %llu expansions, %llu evictions, %llu waits by %d threads in %.1f s; a ray took %.0f ms at most; %.0f "
      "KB "
      "counted at most in a budget of %d KB; gone on beyond it %llu times; %lld entries left\n",
      (unsigned long long)s.expansions, (unsigned long long)s.evictions, (unsigned long long)s.waits, threads,
      seconds_since(start), 1e3 * longest, double(s.total_bytes_peak) / 1000, threads, (unsigned long long)s.overdrafts,
      (long long)live_entries.load());
  return !failed && live_entries == 0 && longest < 1 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const double expansions = argc > 1 ? std::atof(argv[1]) : 1e6;
  const int threads = argc > 2 ? std::atoi(argv[2]) : 16;
  measure_hits();
  live_entries = 0;
  return stress(std::uint64_t(expansions), threads);
}
