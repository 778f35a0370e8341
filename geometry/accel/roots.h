// Roots: makes what rays are traced into of the parts of a scene, and keeps those that several placements share.
#pragma once

#include "geometry/accel/instances.h"
#include "geometry/accel/known_cells.h"
#include "geometry/accel/world.h"

#include <atomic>
#include <map>
#include <mutex>
#include <tuple>

namespace meristem {

class Roots {
 public:
  // Cache, counts and scratch file must outlive it.
  Roots(ExpandMode mode, int threads, GeometryCache& cache, ExpansionCounts& counts, ScratchFile* scratch = nullptr)
      : mode_(mode),
        threads_(threads),
        cache_(cache),
        counts_(counts),
        scratch_(scratch),
        known_(most_known_bytes(cache)) {}

  // Places parts in a frame whose footprint is given (null: everything in full). `parent`: the cache entry that will
  // own them. Any thread; expands nothing but in flat mode.
  std::unique_ptr<Instances> place(const std::vector<Placement>& placements,
                                   const std::shared_ptr<const Footprint>& footprint, CacheEntry* parent,
                                   Key individual, bool are_objects);
  // Of cells of all roots, after they were evicted.
  KnownCells& known() { return known_; }
  // Of the roots that are shared, nothing expanded, and of what is known.
  std::size_t bytes() const { return bytes_.load(std::memory_order_relaxed) + known_.bytes(); }

 private:
  // What Instances own beside those that are shared.
  struct Owner {
    CacheEntry* parent;
    std::vector<std::unique_ptr<ModelRoot>> roots;
  };
  static std::size_t most_known_bytes(const GeometryCache& cache);
  std::unique_ptr<ModelRoot> make(RootSource source);
  const ModelRoot& root_of(const Placement& shown, std::shared_ptr<const Footprint> seen_as, Key individual, Key moment,
                           Owner& owner);
  const ModelRoot& shared(RootSource source);

  const ExpandMode mode_;
  const int threads_;
  GeometryCache& cache_;
  ExpansionCounts& counts_;
  ScratchFile* const scratch_;
  std::mutex mutex_;
  // By part, individual and, where the footprint is constant, its size.
  std::map<std::tuple<const Part*, Key, double>, std::unique_ptr<ModelRoot>> shared_;
  std::atomic<std::size_t> bytes_{0};
  KnownCells known_;
};

}  // namespace meristem
