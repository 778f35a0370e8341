#include "renderer/session/queued_paths.h"

#include "geometry/base/check.h"
#include "geometry/base/parallel.h"
#include "renderer/film/film.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <optional>
#include <utility>

namespace meristem {

namespace {

// Paths that memory is asked for at once.
constexpr std::size_t chunk_paths = 1024;
// What a thread claims: enough that the lock does not matter, few enough that others find something. Of those that wait
// for a cell mostly all, so that no two threads wait for one expansion.
constexpr std::size_t most_begun = 64, most_claimed = 4096;
// So many paths ahead of the one that is followed memory is asked for, and as many before, where that lies.
constexpr std::size_t paths_ahead = 3;

using Clock = std::chrono::steady_clock;
using StateWord = void*;  // as a state is aligned

}  // namespace

struct QueuedPaths::Slot {
  PixelSample sample;
  std::uint32_t dimension = 0;  // of random numbers
  std::int8_t weight = 0;
  bool is_begun = false;
  bool covered = false;  // once it has ended
  bool has_early = false, early_met = false;
  std::unique_ptr<SurfaceHit> early;  // an answer that came before it may be given; if it met something
  std::array<RaySearch, PathStepper::most_rays> searches;

  std::size_t bytes_beside() const {
    std::size_t bytes = early ? sizeof(SurfaceHit) + KeptCells::malloc_bytes : 0;
    for (const RaySearch& search : searches) bytes += search.bytes();
    return bytes;
  }
};

// The cells that a path waits for.
struct QueuedPaths::Wait {
  static_assert(PathStepper::most_rays <= WaitingQueues::most_names);
  std::uint32_t id, count;
  std::array<Key, WaitingQueues::most_names> names;

  Wait(std::uint32_t path, const Slot& slot);
};

QueuedPaths::Wait::Wait(std::uint32_t path, const Slot& slot) : id(path) {
  auto end = names.begin();
  if (!slot.is_begun) *end++ = 0;
  for (const RaySearch& search : slot.searches) {
    const std::optional<Key> name = search.waits_for();
    if (name && std::find(names.begin(), end, *name) == end) *end++ = *name;
  }
  count = std::uint32_t(end - names.begin());
}

// What a path has taken, over all its turns.
struct QueuedPaths::Cost {
  std::uint64_t nanoseconds = 0;
  ThreadExpansions expansions;
};

// Adds the time and the expansions of one turn to a cost, if there is one.
class QueuedPaths::Meter {
 public:
  Meter(Cost* cost, const Intersector& world, bool is_begun) : cost_(cost), world_(world) {
    if (!cost_) return;
    if (!is_begun) *cost_ = {};
    started_ = Clock::now();
    before_ = world_.thread_expansions();
  }
  ~Meter() { stop(); }
  Meter(const Meter&) = delete;
  Meter& operator=(const Meter&) = delete;

  void stop() {
    if (!cost_) return;
    cost_->expansions += world_.thread_expansions() - before_;
    cost_->nanoseconds += std::uint64_t(std::chrono::nanoseconds(Clock::now() - started_).count());
    cost_ = nullptr;
  }

 private:
  Cost* cost_;
  const Intersector& world_;
  Clock::time_point started_;
  ThreadExpansions before_;
};

struct QueuedPaths::Chunk {
  std::vector<Slot> slots;
  std::vector<StateWord> states;
  std::vector<FirstSurface> first;  // if wanted, as the next
  std::vector<Cost> costs;

  static std::size_t bytes(std::size_t state_words, PathWants wants) {
    return sizeof(Chunk) +
           chunk_paths * (sizeof(Slot) + state_words * sizeof(StateWord) +
                          (wants.first_surface ? sizeof(FirstSurface) : 0) + (wants.costs ? sizeof(Cost) : 0));
  }
  Chunk(std::size_t state_words, PathWants wants) : slots(chunk_paths), states(chunk_paths * state_words) {
    if (wants.first_surface) first.resize(chunk_paths);
    if (wants.costs) costs.resize(chunk_paths);
  }
};

// What one thread has of its own.
struct QueuedPaths::Worker {
  const Exchange& exchange;
  int thread;
  std::unique_ptr<Sampler> sampler;
  RayCounts rays;
  std::vector<std::uint32_t> claimed;
  Key woken_for = 0;  // the cell for which all of them waited, unless they have not begun
  std::vector<std::uint32_t> ended;
  std::vector<FilmSample> samples;  // of those
  std::vector<Wait> waiting;
};

QueuedPaths::QueuedPaths(const Scene& scene, const CameraPaths& camera, PathWants wants, std::size_t most_bytes)
    : scene_(scene),
      stepper_(*scene.integrator->stepper()),
      camera_(camera),
      wants_(wants),
      most_bytes_(most_bytes),
      state_words_((stepper_.state_bytes() + sizeof(StateWord) - 1) / sizeof(StateWord)) {
  chunks_.reserve(most_bytes / Chunk::bytes(state_words_, wants_) + 1);
}

QueuedPaths::~QueuedPaths() = default;

QueuedPaths::Slot& QueuedPaths::slot(std::uint32_t id) { return chunks_[id / chunk_paths]->slots[id % chunk_paths]; }

void* QueuedPaths::state(std::uint32_t id) {
  return &chunks_[id / chunk_paths]->states[id % chunk_paths * state_words_];
}

void QueuedPaths::run(int threads, const Exchange& exchange, std::vector<RayCounts>& rays) {
  exhausted_ = false;
  working_ = 0;
  run_threads(threads, [&](int thread) {
    Worker worker{exchange, thread, scene_.sampler->clone(), {}, {}, {}, {}, {}, {}};
    try {
      work(worker);
    } catch (...) {
      {
        const std::lock_guard lock(mutex_);
        failed_ = true;
      }
      changed_.notify_all();
      throw;
    }
    rays[std::size_t(thread)] += worker.rays;
  });
}

void QueuedPaths::work(Worker& worker) {
  while (claim(worker)) {
    std::size_t done = 0;
    for (std::size_t i = 0; i < std::min(2 * paths_ahead, worker.claimed.size()); ++i) prefetch(worker.claimed[i]);
    for (; done < worker.claimed.size() && !worker.exchange.stopped(); ++done) {
      if (done + 2 * paths_ahead < worker.claimed.size()) prefetch(worker.claimed[done + 2 * paths_ahead]);
      if (done + paths_ahead < worker.claimed.size())
        for (const RaySearch& search : slot(worker.claimed[done + paths_ahead]).searches) search.prefetch();
      follow(worker, worker.claimed[done]);
      if (worker.thread == 0) worker.exchange.look_around();
    }
    worker.claimed.erase(worker.claimed.begin(), worker.claimed.begin() + std::ptrdiff_t(done));
    hand_back(worker);
  }
}

// Those that were not followed because of a stop go back to where they waited; those that have not begun wait together.
void QueuedPaths::hand_back(Worker& worker) {
  for (const std::uint32_t id : worker.claimed) worker.waiting.emplace_back(id, slot(id));
  deliver(worker);
  bool others_wait;
  {
    const std::lock_guard lock(mutex_);
    for (const Wait& wait : worker.waiting) queues_.add(std::span(wait.names).first(wait.count), wait.id);
    statistics_.waits += worker.waiting.size();
    free_.insert(free_.end(), worker.ended.begin(), worker.ended.end());
    alive_ -= worker.ended.size();
    statistics_.bytes_peak = std::max<std::uint64_t>(statistics_.bytes_peak, bytes(worker.exchange));
    --working_;
    others_wait = sleeping_ > 0;
  }
  worker.claimed.clear(), worker.waiting.clear(), worker.ended.clear();
  if (others_wait) changed_.notify_all();
}

// New paths before old ones: the more wait, the more a cell serves. False: there is nothing left to do.
bool QueuedPaths::claim(Worker& worker) {
  std::unique_lock lock(mutex_);
  while (true) {
    if (failed_ || worker.exchange.stopped()) return false;
    begin_paths(worker);
    if (worker.claimed.empty() && !queues_.empty()) {
      // The longest queue and the oldest in turns. By length alone, paths of rare cells end last, keep their memory
      // from others, and leave pixels without any sample if the render is stopped; by age alone, few share a cell.
      if (!queues_.take_from_named(worker.woken_for, most_claimed, worker.claimed))
        worker.woken_for = *(++statistics_.served % 16 == 0 ? queues_.take_from_oldest(most_claimed, worker.claimed)
                                                            : queues_.take_from_longest(most_claimed, worker.claimed));
    }
    if (!worker.claimed.empty()) {
      ++working_;
      return true;
    }
    if (working_ == 0) {
      changed_.notify_all();
      return false;
    }
    ++sleeping_;
    if (worker.thread != 0)
      changed_.wait(lock);
    else
      changed_.wait_for(lock, std::chrono::milliseconds(50));
    --sleeping_;
    if (worker.thread != 0) continue;
    lock.unlock();
    worker.exchange.look_around();
    lock.lock();
  }
}

void QueuedPaths::begin_paths(Worker& worker) {
  while (!exhausted_ && worker.claimed.size() < most_begun && has_room(worker.exchange)) {
    PixelSample sample;
    if (!worker.exchange.next(sample)) {
      exhausted_ = true;
      return;
    }
    const std::uint32_t id = free_.back();
    free_.pop_back();
    slot(id).sample = sample;
    slot(id).is_begun = false;
    worker.claimed.push_back(id);
    statistics_.paths_peak = std::max<std::uint64_t>(statistics_.paths_peak, ++alive_);
  }
}

// For another path; one is always alive. The searches of paths that have just begun will grow. A slow start: until most
// cells have been expanded once their boxes are wide, and a ray notes hundreds of them.
bool QueuedPaths::has_room(const Exchange& exchange) {
  constexpr std::uint64_t paths_at_start = 2048, paths_a_serving = 1024;
  if (alive_ >= paths_at_start + paths_a_serving * statistics_.served) return false;
  constexpr std::size_t usual_search_bytes = 128;
  const std::size_t searches = search_bytes_.load(std::memory_order_relaxed),
                    to_come = std::max(searches, alive_ * usual_search_bytes) - searches;
  // Chunks stay. So with each some room must be left for samples that come before their turn: else the more of these
  // there are, the more paths of chunks would be idle.
  const std::size_t early_samples = std::max(exchange.bytes(), most_bytes_ / 8) - exchange.bytes();
  const std::size_t new_chunk = free_.empty() ? Chunk::bytes(state_words_, wants_) + early_samples : 0;
  const std::size_t in_hands = most_bytes_ / 64;  // what paths that threads follow now come back with
  if (alive_ > 0 && bytes(exchange) + to_come + new_chunk + in_hands > most_bytes_) return false;
  if (!free_.empty()) return true;
  if (chunks_.size() == chunks_.capacity()) return false;
  const std::size_t first = chunks_.size() * chunk_paths;
  chunks_.push_back(std::make_unique<Chunk>(state_words_, wants_));
  for (std::size_t i = chunk_paths; i-- > 0;) free_.push_back(std::uint32_t(first + i));
  return true;
}

std::size_t QueuedPaths::bytes(const Exchange& exchange) const {
  return exchange.bytes() + chunks_.size() * Chunk::bytes(state_words_, wants_) +
         search_bytes_.load(std::memory_order_relaxed) + queues_.bytes() + free_.capacity() * sizeof(std::uint32_t);
}

// What a path was when it began to wait has long left the processor's caches.
void QueuedPaths::prefetch(std::uint32_t id) {
  constexpr std::size_t cache_line = 64;
  const auto touch = [](const void* from, std::size_t bytes) {
    for (std::size_t at = 0; at < bytes; at += cache_line) __builtin_prefetch(static_cast<const char*>(from) + at);
  };
  touch(&slot(id), sizeof(Slot));
  touch(state(id), state_words_ * sizeof(StateWord));
}

// Until the path ends or waits.
void QueuedPaths::follow(Worker& worker, std::uint32_t id) {
  Slot& s = slot(id);
  Chunk& chunk = *chunks_[id / chunk_paths];
  FirstSurface* first = wants_.first_surface ? &chunk.first[id % chunk_paths] : nullptr;
  Sampler& sampler = *worker.sampler;
  const PathTools tools{scene_, sampler, worker.rays, first};
  Meter meter(wants_.costs ? &chunk.costs[id % chunk_paths] : nullptr, *scene_.intersector, s.is_begun);
  const std::size_t bytes_before = s.bytes_beside();
  if (s.is_begun) {
    for (RaySearch& search : s.searches) search.wake(worker.woken_for);
    sampler.start(s.sample.x, s.sample.y, int(s.sample.number), scene_.settings.seed);
    sampler.go_to(s.dimension);
  } else {
    if (first) *first = {};
    const CameraPaths::Start start = camera_.start(s.sample, sampler);
    if (first) first->time = start.ray.time;
    s.weight = std::int8_t(start.weight);
    s.is_begun = true;
    stepper_.begin(state(id), start.ray, tools);
  }
  const std::uint64_t escaped = worker.rays.escaped;
  if (go_on(id, tools)) {
    s.dimension = sampler.dimension();
    worker.waiting.emplace_back(id, s);
  } else {
    meter.stop();
    s.covered = worker.rays.escaped == escaped;
    worker.ended.push_back(id);
  }
  search_bytes_.fetch_add(s.bytes_beside() - bytes_before, std::memory_order_relaxed);  // modulo 2^64
}

// Whether the path waits now. Both rays of a vertex are searched, at first and when a cell comes up that both enter;
// the second is answered after the first.
bool QueuedPaths::go_on(std::uint32_t id, const PathTools& tools) {
  Slot& s = slot(id);
  void* const path = state(id);
  while (true) {
    const bool light_waits = !meets_light(id, tools);
    const RayRequest request = stepper_.request(path, 1);
    if (request.kind == RayRequest::Kind::None) return light_waits;
    ShadingPoint point;
    if (!s.has_early) {
      const RaySearch::End end = search(request, s.searches[1], point.hit);
      if (end == RaySearch::End::Waits) return true;
      s.early_met = end == RaySearch::End::Met;
      if (light_waits && s.early_met) s.early = std::make_unique<SurfaceHit>(point.hit);
      s.has_early = true;
    } else if (!light_waits && s.early) {
      point.hit = *std::exchange(s.early, nullptr);
    }
    if (light_waits) return true;
    s.has_early = false;
    stepper_.answer(path, 1, s.early_met, point, tools);
  }
}

// False if the ray to the light waits.
bool QueuedPaths::meets_light(std::uint32_t id, const PathTools& tools) {
  while (true) {
    const RayRequest request = stepper_.request(state(id), 0);
    if (request.kind == RayRequest::Kind::None) return true;
    ShadingPoint point;
    const RaySearch::End end = search(request, slot(id).searches[0], point.hit);
    if (end == RaySearch::End::Waits) return false;
    stepper_.answer(state(id), 0, end == RaySearch::End::Met, point, tools);
  }
}

RaySearch::End QueuedPaths::search(const RayRequest& request, RaySearch& search, SurfaceHit& hit) const {
  if (search.sleeps()) return RaySearch::End::Waits;
  return scene_.intersector->search(request.ray, request.kind == RayRequest::Kind::Any, search, hit);
}

// The samples of paths that have ended, all at once: a lock for each would cost as much as short paths do.
void QueuedPaths::deliver(Worker& worker) {
  worker.samples.clear();
  for (const std::uint32_t id : worker.ended) worker.samples.push_back(film_sample(id));
  const std::lock_guard lock(delivery_);
  for (std::size_t i = 0; i < worker.ended.size(); ++i)
    worker.exchange.deliver(slot(worker.ended[i]).sample, worker.samples[i]);
}

FilmSample QueuedPaths::film_sample(std::uint32_t id) {
  const Slot& s = slot(id);
  const Chunk& chunk = *chunks_[id / chunk_paths];
  FilmSample sample{
      .radiance = stepper_.result(state(id)), .covered = s.covered, .weight = s.weight, .number = s.sample.number};
  if (wants_.first_surface) sample.first = &chunk.first[id % chunk_paths];
  camera_.measure(sample);
  if (wants_.costs) {
    const Cost& cost = chunk.costs[id % chunk_paths];
    sample.nanoseconds = cost.nanoseconds;
    sample.expansions = cost.expansions;
  }
  return sample;
}

QueueStatistics QueuedPaths::statistics() const {
  const std::lock_guard lock(mutex_);
  return statistics_;
}

}  // namespace meristem
