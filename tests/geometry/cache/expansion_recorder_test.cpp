#include "geometry/cache/expansion_recorder.h"

#include <gtest/gtest.h>

#include <numeric>

namespace meristem {
namespace {

TEST(Timeline, KeepsItsSumsAndItsPeakWhenBinsAreMerged) {
  Timeline timeline(0.001);
  constexpr int events = 50000;
  double work = 0;
  for (int i = 0; i < events; ++i) {
    const double time = i * 0.0007;  // 35 s: the bins double six times
    ++timeline.at(time).expanded;
    timeline.add_work(std::max(0.0, time - 0.004), time, &TimelineBin::expand_s);
    work += std::min(time, 0.004);
    timeline.set_memory(time, {.surfaces = i == 12345 ? 1000u : 10u});
  }
  EXPECT_LE(timeline.size(), Timeline::max_bins);
  EXPECT_GT(timeline.size(), Timeline::max_bins / 2);
  std::uint64_t expanded = 0, most = 0;
  double expand_s = 0;
  for (const TimelineBin& bin : timeline.bins()) {
    expanded += bin.expanded;
    expand_s += bin.expand_s;
    most = std::max(most, bin.memory.surfaces);
    EXPECT_GT(bin.memory.surfaces, 0u);
  }
  EXPECT_EQ(expanded, std::uint64_t(events));
  EXPECT_NEAR(expand_s, work, 1e-6);
  EXPECT_EQ(most, 1000u);
  EXPECT_EQ(timeline.bins()[std::size_t(12345 * 0.0007 / timeline.bin_s())].memory.surfaces, 1000u);
}

TEST(LatencyHistogram, QuantilesLieInTheirBins) {
  LatencyHistogram h;
  EXPECT_EQ(h.quantile_s(0.5), 0);
  for (int i = 1; i <= 1000; ++i) h.add(i * 1e-3);
  h.add(1e9);
  h.add(0);
  EXPECT_EQ(h.total(), 1002u);
  EXPECT_EQ(h.max_s, 1e9);
  const double width = LatencyHistogram::lower_bound_s(1) / LatencyHistogram::lower_bound_s(0);
  EXPECT_GE(h.quantile_s(0.5), 0.5);
  EXPECT_LE(h.quantile_s(0.5), 0.5 * width);
}

struct Entry : CacheEntry {
  Entry(CellLabel l, std::size_t size) {
    label = l;
    bytes = size;
  }
};

// Cells of 100 bytes, 40 of them Embree's, behind a cache with a recorder.
class RecordedCache {
 public:
  explicit RecordedCache(std::size_t budget) : recorder_(budget, [] { return 7; }), cache_(budget, &recorder_) {
    class_ = recorder_.class_of({"oak", 2, "leaf", true});
  }
  void use(std::size_t cell) {
    const GeometryCache::Visit visit(cache_);
    cache_.acquire(slots_[cell], nullptr, {}, [&] {
      const double start_s = recorder_.now_s();
      recorder_.add_expansion({class_, start_s, start_s, recorder_.now_s(), 16, 100, 3});
      return std::make_unique<Entry>(CellLabel{cell + 1, class_, true, 40}, 100);
    });
  }
  ExpansionProfile profile() const { return recorder_.profile(); }
  CacheStatistics statistics() const { return cache_.statistics(); }
  ExpansionRecorder& recorder() { return recorder_; }

 private:
  ExpansionRecorder recorder_;
  std::vector<CacheSlot> slots_{100};
  GeometryCache cache_;
  std::uint32_t class_;
};

template <class Figure>
std::uint64_t sum(const ExpansionProfile& p, Figure TimelineBin::*figure) {
  return std::accumulate(p.timeline.begin(), p.timeline.end(), std::uint64_t(0),
                         [&](std::uint64_t total, const TimelineBin& bin) { return total + bin.*figure; });
}

TEST(ExpansionRecorder, CountsWhatTheCacheCounts) {
  RecordedCache cache(1000);
  for (int round = 0; round < 3; ++round)
    for (std::size_t cell = 0; cell < 20; ++cell) cache.use(cell);
  const ExpansionProfile p = cache.profile();
  const CacheStatistics s = cache.statistics();
  EXPECT_GT(s.reexpansions, 20u);
  ASSERT_EQ(p.classes.size(), 2u);
  EXPECT_EQ(p.classes[0].expanded, 0u);
  EXPECT_EQ(p.classes[1].expanded, s.expansions);
  EXPECT_EQ(p.classes[1].reexpanded, s.reexpansions);
  EXPECT_EQ(p.classes[1].evicted, s.evictions);
  EXPECT_EQ(p.classes[1].bytes, s.expansions * 100);
  EXPECT_EQ(p.classes[1].faces, s.expansions * 16);
  EXPECT_EQ(p.classes[1].mean_box_ratio(), 3);
  EXPECT_EQ(p.reuse.reexpanded, double(s.reexpansions));
  EXPECT_EQ(p.latency.total(), s.expansions);
  EXPECT_EQ(sum(p, &TimelineBin::expanded), s.expansions);
  EXPECT_EQ(sum(p, &TimelineBin::evicted), s.evictions);
  ASSERT_EQ(p.threads.size(), 1u);
  EXPECT_EQ(p.threads[0].spans.size(), s.expansions);
}

TEST(ExpansionRecorder, TellsWhereTheBytesAre) {
  RecordedCache cache(10000);
  for (std::size_t cell = 0; cell < 5; ++cell) cache.use(cell);
  const GeometryMemory memory = cache.profile().timeline.back().memory;
  EXPECT_EQ(memory.surfaces, 300u);
  EXPECT_EQ(memory.surface_trees, 200u);
  EXPECT_EQ(memory.plans, 7u);
  EXPECT_EQ(memory.resident(), cache.statistics().resident_bytes);
}

TEST(ExpansionRecorder, KeepsABoundedNumberOfSpans) {
  RecordedCache cache(1000);
  const double now = cache.recorder().now_s();
  for (std::size_t i = 0; i < 5 * ExpansionRecorder::max_spans; ++i)
    cache.recorder().add_expansion({0, now, now, now, i, 0, 0});
  const ThreadProfile thread = cache.profile().threads.at(0);
  EXPECT_LE(thread.spans.size(), ExpansionRecorder::max_spans);
  EXPECT_EQ(thread.expansions, 5 * ExpansionRecorder::max_spans);
  for (std::size_t i = 0; i < thread.spans.size(); ++i) ASSERT_EQ(thread.spans[i].faces, i * thread.span_stride);
}

TEST(ExpansionRecorder, SamplesRaysEvenly) {
  RecordedCache cache(1000);
  for (int i = 0; i < 10 * int(ExpansionRecorder::ray_stride); ++i)
    if (std::uint32_t* visits = cache.recorder().begin_ray()) {
      ++visits[0];
      cache.recorder().end_ray();
    }
  EXPECT_EQ(cache.profile().classes[0].visits, 10u * ExpansionRecorder::ray_stride);
  EXPECT_GT(cache.profile().threads.at(0).trace_s, 0);
}

}  // namespace
}  // namespace meristem
