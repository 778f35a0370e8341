// Intersector: the world as rays see it. Expansion, caching and Embree stand behind it; integrators see only this.
#pragma once

#include "geometry/accel/ray_search.h"
#include "geometry/accel/surface.h"
#include "geometry/base/bounds.h"
#include "geometry/base/expansion_profile.h"
#include "geometry/base/statistics.h"

#include <cstdint>
#include <optional>
#include <span>

namespace meristem {

// Expansions that one thread made.
struct ThreadExpansions {
  std::uint64_t expanded = 0;     // the repeated ones among them
  std::uint64_t reexpanded = 0;   // of cells that had been expanded and evicted before
  std::uint64_t acquired = 0;     // cells that its rays asked for, resident or not
  std::uint64_t nanoseconds = 0;  // in which it expanded, or waited for another thread to

  ThreadExpansions& operator+=(const ThreadExpansions& o) {
    expanded += o.expanded, reexpanded += o.reexpanded, acquired += o.acquired, nanoseconds += o.nanoseconds;
    return *this;
  }
  ThreadExpansions operator-(const ThreadExpansions& o) const {
    return {expanded - o.expanded, reexpanded - o.reexpanded, acquired - o.acquired, nanoseconds - o.nanoseconds};
  }
};

// A ray to be traced among others, and its answer.
struct RayQuery {
  const Ray* ray;
  SurfaceHit* hit;  // the nearest, if there is one; null: whether there is one will do
  bool met = false;
  ThreadExpansions* expansions = nullptr;  // if not null, those that the ray makes are added
};

class Intersector;

// Adds what the calling thread expands while it lives to a sum, if there is one.
class ExpansionMeter {
 public:
  ExpansionMeter(const Intersector& world, ThreadExpansions* sum);
  ~ExpansionMeter();
  ExpansionMeter(const ExpansionMeter&) = delete;
  ExpansionMeter& operator=(const ExpansionMeter&) = delete;

 private:
  const Intersector& world_;
  ThreadExpansions* const sum_;
  ThreadExpansions before_;
};

class Intersector {
 public:
  virtual ~Intersector() = default;

  // The nearest hit in (t_min, t_max). Any thread that run_threads() made. Rays must be finite with a direction other
  // than zero (a ray that is not hits nothing and is counted). May expand cells; never throws.
  virtual bool intersect(const Ray& ray, SurfaceHit& hit) const = 0;
  // Whether anything lies in (t_min, t_max).
  virtual bool occluded(const Ray& ray) const = 0;
  void trace_alone(RayQuery& q) const {
    const ExpansionMeter meter(*this, q.expansions);
    q.met = q.hit ? intersect(*q.ray, *q.hit) : occluded(*q.ray);
  }
  // The same for many rays, of which some are on their way at once: while one waits for memory others go on. That takes
  // down to half of the time for rays that have nothing in common. Some dozens are enough. The bits are those of the
  // calls one by one.
  // `are_neighbours`: those that follow each other in the list begin near each other, as those of a camera do; where
  // they also have nearly one direction, several go through the same nodes at once, again in half of the time.
  virtual void trace(std::span<RayQuery> queries, bool are_neighbours = false) const {
    (void)are_neighbours;
    for (RayQuery& q : queries) trace_alone(q);
  }
  // The same for a ray that would rather wait than expand: the nearest hit, or with `any` whether there is one. After
  // Waits the next call, with the same ray and search, expands what it waited for and goes on; after any other end the
  // search is as new. The hit has the bits of intersect().
  virtual RaySearch::End search(const Ray& ray, bool any, RaySearch& search, SurfaceHit& hit) const {
    (void)search;
    return (any ? occluded(ray) : intersect(ray, hit)) ? RaySearch::End::Met : RaySearch::End::Missed;
  }
  // Between passes, while no thread traces: makes what is resident faster to trace, as long as that has room, and keeps
  // it until it is called again, or unsettle(). Costs some microseconds a cell.
  virtual void settle() {}
  // Whether it has done so: trace() has something to gain.
  virtual bool is_settled() const { return false; }
  virtual void unsettle() {}
  // Whether that has become a burden: tracing should stop soon for one of the two.
  virtual bool is_crowded() const { return false; }
  // What the calling thread has expanded since it began to trace: differences say what a pixel cost. A few nanoseconds.
  virtual ThreadExpansions thread_expansions() const { return {}; }
  // Conservative bounds of everything, known before expansion.
  virtual Bounds3f bounds() const = 0;
  // What expansion did so far. Not while threads trace.
  virtual ExpansionStatistics statistics() const { return {}; }
  // What was recorded of it so far; nothing if recording was not asked for. Not while threads trace.
  virtual std::optional<ExpansionProfile> profile() const { return {}; }
};

inline ExpansionMeter::ExpansionMeter(const Intersector& world, ThreadExpansions* sum) : world_(world), sum_(sum) {
  if (sum_) before_ = world_.thread_expansions();
}
inline ExpansionMeter::~ExpansionMeter() {
  if (sum_) *sum_ += world_.thread_expansions() - before_;
}

}  // namespace meristem
