// ExpansionRecorder: makes an ExpansionProfile while rays are traced. Expansions, evictions and waits are recorded, and
// one ray in ray_stride; what is resident already is found without a word about it.
//
// Memory is bounded: 1024 bins of time, 32768 spans a thread (when they are full every second one goes, and from then
// on only every second one comes), 65536 cells whose reuse is followed. An expansion costs about a microsecond more, a
// thousandth of itself; a ray a few nanoseconds.
//
// Threads: any, as in GeometryCache; profile() when none traces.
#pragma once

#include "geometry/base/expansion_profile.h"
#include "geometry/cache/geometry_cache.h"
#include "geometry/cache/reuse_distance.h"
#include "geometry/cache/timeline.h"

#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>

namespace meristem {

// One expansion, by the thread that made it.
struct RecordedExpansion {
  std::uint32_t cell_class = 0;
  double start_s = 0, built_from_s = 0, end_s = 0;  // built_from_s: from there to the end trees were built
  std::uint64_t faces = 0, bytes = 0;
  double box_ratio = 0;  // area of the box before expansion over that of the real one; 0: not known
};

class ExpansionRecorder {
 public:
  static constexpr std::uint32_t max_classes = 1024;  // what comes after counts for the last one
  static constexpr std::uint32_t ray_stride = 64;
  static constexpr std::size_t max_spans = 1 << 15;

  // `plan_bytes` tells what shared plans take; asked at every expansion.
  ExpansionRecorder(std::uint64_t budget_bytes, std::function<std::size_t()> plan_bytes);

  double now_s() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  // The index of a kind of cells, for CellLabel and RecordedExpansion. The first stands for entries without a label.
  std::uint32_t class_of(const CellClass& cells);
  void add_expansion(const RecordedExpansion& expansion);
  void add_wait(double start_s);

  // By the cache, which holds its mutex.
  void expanded(const CellLabel& label, std::size_t bytes);
  void evicted(const CellLabel& label, std::size_t bytes);
  void limbo_is(std::size_t bytes);

  // A ray begins: where to count the cells it meets, by class, if it is one of the sampled; else null.
  std::uint32_t* begin_ray();
  void end_ray();  // of a sampled ray

  ExpansionProfile profile() const;

 private:
  // What a thread records by itself.
  struct ThreadLog {
    ThreadProfile figures;
    std::uint64_t seen_spans = 0;
    bool kept_last_span = false;
    double ray_start_s = 0, busy_before_s = 0;
    std::array<std::uint32_t, max_classes> visits{};
    LatencyHistogram latency, waits;

    double busy_s() const { return figures.expand_s + figures.build_s + figures.wait_s; }
    void add(const ActivitySpan& span);
  };
  ThreadLog& log();
  void change(const CellLabel& label, std::size_t bytes, int sign);
  void note_memory();  // needs mutex_

  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  const std::uint64_t budget_bytes_;
  const std::function<std::size_t()> plan_bytes_;
  std::array<std::unique_ptr<ThreadLog>, GeometryCache::max_threads> logs_;  // each touched by its own thread

  mutable std::mutex mutex_;  // taken last: its holder takes no other. Guards all below
  GeometryMemory memory_;
  Timeline timeline_;
  std::vector<CellClassFigures> classes_;
  ReuseDistances reuse_;
};

}  // namespace meristem
