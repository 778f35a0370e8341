// Roots: makes what rays are traced into of the parts of a scene, and keeps those that several placements share.
#pragma once

#include "geometry/accel/instances.h"
#include "geometry/accel/known_cells.h"
#include "geometry/accel/world.h"
#include "geometry/mesh/plan_table.h"

#include <array>
#include <atomic>
#include <deque>
#include <mutex>

namespace meristem {

// What a cell expands to; of ground, before anything is placed on it.
struct ExpandedCell {
  Expansion expansion;
  std::int32_t symbol;  // of its first face

  std::size_t bytes() const {
    return sizeof(*this) + expansion.mesh.mesh.bytes() + (expansion.inner ? expansion.inner->bytes() : 0);
  }
};

// The whole of a wide ground takes some megabytes.
using GroundTable = PlanTable<ExpandedCell, std::size_t(16) << 20>;

class Roots {
 public:
  // Cache, counts and scratch file must outlive it.
  Roots(const WorldOptions& options, GeometryCache& cache, ExpansionCounts& counts, ScratchFile* scratch = nullptr)
      : mode_(options.mode),
        threads_(options.threads),
        uv_readers_(options.uv_readers),
        cache_(cache),
        counts_(counts),
        scratch_(scratch),
        known_(most_known_bytes(cache)) {
    constexpr std::size_t share = 16;
    grounds_.set_capacity(cache.budget_bytes() / share);
  }

  // Places parts in a frame whose footprint is given (null: everything in full). `parent`: the cache entry that will
  // own them. `are_objects`, `first`: as for Instances. Any thread; expands nothing but in flat mode.
  std::unique_ptr<Instances> place(const std::vector<Placement>& placements,
                                   const std::shared_ptr<const Footprint>& footprint, CacheEntry* parent,
                                   Key individual, bool are_objects, std::uint32_t first = 0);
  const UvReaders& uv_readers() const { return uv_readers_; }
  // Of cells of all roots, after they were evicted.
  KnownCells& known() { return known_; }
  // Cells of ground that were expanded of late. What stands on one ground is placed by several placers and for several
  // classes of rays, which come to the same place soon after each other.
  GroundTable& grounds() { return grounds_; }
  // Of the roots that are shared, nothing expanded, of what is known, and of grounds.
  std::size_t bytes() const { return bytes_.load(std::memory_order_relaxed) + known_.bytes() + grounds_.bytes(); }

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
  const ModelRoot* shared_root_of(const Placement& placed, const Footprint::Range& footprint, bool fades,
                                  Key individual);
  const ModelRoot& shared(RootSource source);
  const ModelRoot* find_shared(const Part* part, Key individual, double size) const;

  const ExpandMode mode_;
  const int threads_;
  const UvReaders uv_readers_;
  GeometryCache& cache_;
  ExpansionCounts& counts_;
  ScratchFile* const scratch_;
  // A root that is shared, by part, individual and, where the footprint is constant, its size.
  struct Shared {
    const Part* part;
    Key individual;
    double size;
    std::unique_ptr<ModelRoot> root;
    const Shared* next;  // of its bucket
  };
  static std::size_t bucket(const Part* part, Key individual, double size);
  static constexpr std::size_t buckets = 1 << 12;

  std::mutex mutex_;
  std::deque<Shared> shared_;                                    // guarded by mutex_
  std::array<std::atomic<const Shared*>, buckets> by_bucket_{};  // read without; each placement asks once
  std::atomic<std::size_t> bytes_{0};
  KnownCells known_;
  GroundTable grounds_;
};

}  // namespace meristem
