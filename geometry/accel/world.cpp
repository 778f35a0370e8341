#include "geometry/accel/world.h"

#include "geometry/accel/class_worlds.h"
#include "geometry/accel/leaf_store.h"
#include "geometry/accel/root_generations.h"
#include "geometry/accel/search_driver.h"
#include "geometry/accel/streamed_rays.h"
#include "geometry/base/parallel.h"
#include "geometry/mesh/limit.h"
#include "geometry/mesh/refine_plan.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <new>
#include <numeric>

namespace meristem {

namespace {

constexpr std::size_t unlimited_bytes = std::numeric_limits<std::size_t>::max();

// Of the tables that all cells share.
std::size_t shared_plan_bytes() { return refine_plan_bytes() + limit_plan_bytes(); }

// Of a small budget, the most that plans may take. Those of limits are small and few.
constexpr double refine_plan_share = 0.125, limit_plan_share = 0.05, plan_share = refine_plan_share + limit_plan_share;

void limit_plans(const WorldOptions& options) {
  const double budget = options.mode == ExpandMode::Lazy ? double(options.budget_bytes) : double(unlimited_bytes);
  set_refine_plan_capacity(std::size_t(budget * refine_plan_share));
  set_limit_plan_capacity(std::size_t(budget * limit_plan_share));
}

std::unique_ptr<ExpansionRecorder> make_recorder(const WorldOptions& options) {
  if (!options.record || options.mode == ExpandMode::Flat) return nullptr;
  const std::size_t budget = options.mode == ExpandMode::Lazy ? options.budget_bytes : 0;
  return std::make_unique<ExpansionRecorder>(budget, shared_plan_bytes);
}

std::unique_ptr<ScratchFile> make_scratch(const WorldOptions& options) {
  if (options.scratch_directory.empty() || options.mode != ExpandMode::Lazy) return nullptr;
  return std::make_unique<ScratchFile>(options.scratch_directory);
}

// A visit to the cache while one lives, if entries may leave it at all.
class VisitIfEvicted {
 public:
  explicit VisitIfEvicted(GeometryCache& cache) {
    if (cache.budget_bytes() != unlimited_bytes) visit_.emplace(cache);
  }

 private:
  std::optional<GeometryCache::Visit> visit_;
};

class World final : public Intersector {
 public:
  World(std::vector<Placement> objects, const WorldOptions& options)
      : recorder_(make_recorder(options)),
        scratch_(make_scratch(options)),
        cache_(options.mode == ExpandMode::Lazy ? options.budget_bytes : unlimited_bytes, recorder_.get(),
               [this] { return bytes_beside_cells(); }),
        counts_(recorder_.get()),
        roots_(options, cache_, counts_, scratch_.get()) {
    limit_plans(options);
    run_isolated([&] { worlds_ = std::make_unique<ClassWorlds>(objects, options, roots_); });
    if (options.mode != ExpandMode::Lazy) expand_everything(worlds_->roots(), options.threads);
    settle();
  }

  bool intersect(const Ray& ray, SurfaceHit& hit) const override {
    if (!can_meet(ray)) return false;
    Tracing tracing(ray, recorder_.get());
    RayContext& context = tracing.context;
    const VisitIfEvicted visit(cache_);
    worlds_->route(ray).intersect(context, tracing.query);
    if (context.acquired > 0) cache_.count_acquired(context.acquired);
    if (context.patch) tracing.surface_hit(hit);
    return context.patch != nullptr;
  }

  bool occluded(const Ray& ray) const override {
    if (!can_meet(ray)) return false;
    Tracing tracing(ray, recorder_.get());
    RayContext& context = tracing.context;
    RTCRay& query = tracing.query.ray;
    const VisitIfEvicted visit(cache_);
    // What is resident may be in the way, and spare what is not its expansion.
    const RayRoute route = worlds_->route(ray);
    context.only_resident = true;
    route.occluded(context, query);
    context.only_resident = false;
    if (query.tfar >= 0 && context.has_passed_by) route.occluded(context, query);
    if (context.acquired > 0) cache_.count_acquired(context.acquired);
    return query.tfar < 0;
  }

  void trace(std::span<RayQuery> queries, bool are_neighbours) const override {
    const auto is_sound = [](const RayQuery& q) { return is_valid(*q.ray); };
    if (queries.size() < 2 || !has_passages_ || !std::ranges::all_of(queries, is_sound))
      return Intersector::trace(queries, are_neighbours);
    const VisitIfEvicted visit(cache_);
    StreamedRays rays(*this, *worlds_, recorder_.get(), queries);
    rays.trace(are_neighbours);
    if (rays.acquired() > 0) cache_.count_acquired(rays.acquired());
  }

  RaySearch::End search(const Ray& ray, bool any, RaySearch& search, SurfaceHit& hit) const override {
    if (!can_meet(ray)) return RaySearch::End::Missed;
    Tracing tracing(ray, recorder_.get());
    RayContext& context = tracing.context;
    SearchDriver driver(search, any, context, tracing.query);
    RaySearch::End end = RaySearch::End::Missed;
    {
      const GeometryCache::Visit visit(cache_);
      end = driver.go_on(worlds_->route(ray), cache_);
      if (context.patch && !driver.overflows()) tracing.surface_hit(hit);
    }
    cache_.count_acquired(context.acquired);
    if (driver.overflows()) {
      driver.end();
      return Intersector::search(ray, any, search, hit);
    }
    if (end == RaySearch::End::Waits)
      driver.keep(context.patch ? &hit : nullptr);
    else if (end == RaySearch::End::Met && !any && !context.patch)
      hit = driver.kept();
    if (end != RaySearch::End::Waits) driver.end();
    return end;
  }

  void unsettle() override {
    unbraid();
    tighten();
  }
  void settle() override {
    unbraid();
    if (has_room_to_keep()) {
      cache_.keep_resident();
      try {
        braid();
      } catch (const std::bad_alloc&) {  // rays go through the cells, as before
        unbraid();
      }
    }
    tighten();
  }
  bool is_settled() const override { return has_passages_; }
  bool is_crowded() const override { return cache_.is_crowded(); }

  ThreadExpansions thread_expansions() const override {
    const GeometryCache::ThreadCounts counts = cache_.thread_counts();
    return {counts.expansions, counts.reexpansions, counts.acquired, counts.nanoseconds};
  }
  Bounds3f bounds() const override { return worlds_->bounds(); }

  ExpansionStatistics statistics() const override {
    ExpansionStatistics s;
    const CacheStatistics c = cache_.statistics();
    counts_.write(s);
    s.cells_expanded = c.expansions;
    s.reexpanded = c.reexpansions;
    s.evicted = c.evictions;
    s.failed += c.failures;
    s.waits = c.waits;
    s.resident_bytes_peak = c.resident_bytes_peak;
    s.limbo_bytes_peak = c.limbo_bytes_peak;
    s.plan_bytes = shared_plan_bytes();
    s.total_bytes_peak = std::max(c.total_bytes_peak, c.resident_bytes + c.limbo_bytes + bytes_beside_cells());
    s.invalid_rays = invalid_rays_.load();
    s.read_back = scratch_ ? scratch_->read_back() : 0;
    s.scratch_bytes = scratch_ ? scratch_->bytes() : 0;
    return s;
  }

  std::optional<ExpansionProfile> profile() const override {
    return recorder_ ? std::optional(recorder_->profile()) : std::nullopt;
  }

 private:
  static bool is_valid(const Ray& ray) {
    return is_finite(ray.origin) && is_finite(ray.direction) && ray.direction != Vec3f{};
  }
  bool can_meet(const Ray& ray) const {
    if (!is_valid(ray)) {
      invalid_rays_.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    return !worlds_->empty();
  }

  // Roots that do not wait for each other at once.
  void braid() {
    const std::vector<std::vector<const ModelRoot*>> generations = root_generations(worlds_->roots());
    for (const std::vector<const ModelRoot*>& roots : generations)
      braided_.insert(braided_.end(), roots.begin(), roots.end());
    for (const std::vector<const ModelRoot*>& roots : generations) braid(roots);
    worlds_->braid();
  }

  void braid(const std::vector<const ModelRoot*>& roots) {
    std::vector<std::size_t> bytes(roots.size());
    parallel_for(roots.size(), [&](std::size_t i) { bytes[i] = roots[i]->braid(); });
    braid_bytes_ += std::accumulate(bytes.begin(), bytes.end(), std::size_t(0));
    has_passages_ = has_passages_ || std::ranges::any_of(roots, [](const ModelRoot* r) { return r->passage(); });
  }

  void unbraid() {
    worlds_->unbraid();
    for (const ModelRoot* root : braided_) root->unbraid();
    braided_.clear();
    braid_bytes_ = 0;
    has_passages_ = false;
    cache_.release_kept();
  }

  void tighten() {
    try {
      run_isolated([&] { worlds_->tighten(); });
    } catch (const std::bad_alloc&) {  // boxes stay as wide as they were
    }
  }

  // What is kept must leave a part of the budget to what will be expanded, and to braids: a few hundredths, of what is
  // placed up to a third.
  bool has_room_to_keep() const {
    constexpr double most_kept = 0.75;
    const CacheStatistics c = cache_.statistics();
    return c.evictions == 0 &&
           double(c.resident_bytes + bytes_beside_cells()) <= most_kept * double(cache_.budget_bytes());
  }

  std::size_t bytes_beside_cells() const {
    return shared_plan_bytes() + roots_.bytes() + (worlds_ ? worlds_->bytes() : 0) +
           (scratch_ ? scratch_->index_bytes() : 0) + braid_bytes_;
  }

  const std::unique_ptr<ExpansionRecorder> recorder_;  // null: nothing is recorded
  const std::unique_ptr<ScratchFile> scratch_;         // null: none
  mutable GeometryCache cache_;
  ExpansionCounts counts_;
  mutable std::atomic<std::uint64_t> invalid_rays_{0};
  Roots roots_;
  std::unique_ptr<ClassWorlds> worlds_;
  std::vector<const ModelRoot*> braided_;
  std::size_t braid_bytes_ = 0;
  bool has_passages_ = false;  // of braided_
};

}  // namespace

std::size_t least_budget(const std::vector<Placement>& objects, const WorldOptions& options) {
  constexpr std::size_t ample_bytes_per_thread = std::size_t(64) << 20;
  const auto threads = std::size_t(options.threads);
  if (options.mode != ExpandMode::Lazy || options.budget_bytes >= threads * ample_bytes_per_thread) return 0;
  GeometryCache cache(unlimited_bytes);
  ExpansionCounts counts;
  Roots roots(options, cache, counts);
  std::unique_ptr<ClassWorlds> worlds;
  run_isolated([&] { worlds = std::make_unique<ClassWorlds>(objects, options, roots); });
  const std::size_t entries = worlds->bytes() + roots.bytes() + threads * largest_chain_bytes(worlds->roots());
  return std::size_t(double(entries) / (1 - plan_share));
}

std::unique_ptr<Intersector> make_world(std::vector<Placement> objects, const WorldOptions& options) {
  return std::make_unique<World>(std::move(objects), options);
}

}  // namespace meristem
