#include "renderer/session/session.h"

#include "geometry/base/check.h"
#include "geometry/base/parallel.h"
#include "renderer/film/noise.h"
#include "renderer/session/path_batch.h"
#include "renderer/session/process_clock.h"
#include "renderer/session/sample_sequence.h"
#include "renderer/session/tiles.h"

#include <algorithm>
#include <chrono>

namespace meristem {

namespace {

constexpr double report_interval_s = 0.1;

constexpr int sparse_step = 4;  // pixels, in x and y

PixelWindow visible_window(const RenderSettings& settings, const std::optional<PixelWindow>& crop) {
  const PixelWindow frame{0, 0, settings.width, settings.height};
  return crop ? crop->intersected(frame) : frame;
}

// Adaptive sampling asks the film for variances.
std::vector<Aov> film_aovs(const RenderSettings& settings) {
  std::vector<Aov> aovs = settings.aovs;
  const auto at = std::ranges::lower_bound(aovs, Aov::Variance);
  if (settings.noise > 0 && (at == aovs.end() || *at != Aov::Variance)) aovs.insert(at, Aov::Variance);
  return aovs;
}

RayOrder possible_order(const Scene& scene) {
  return scene.integrator->stepper() ? scene.settings.ray_order : RayOrder::DepthFirst;
}

// The tile that is taken as the i-th while little is there: those that follow each other lie in as many parts of the
// picture as there are threads, so that one seldom has to wait for what another expands.
std::size_t apart(std::size_t i, std::size_t tiles, std::size_t threads) {
  const std::size_t part = tiles / threads;
  return i < part * threads ? i % threads * part + i / threads : i;
}

}  // namespace

// What one thread has of its own during a pass.
struct RenderSession::Worker {
  int thread;
  std::uint32_t pass_end;
  int step;  // between its pixels
  std::unique_ptr<Sampler> sampler;
  RayCounts rays;
  ThreadExpansions watched;        // those before the cells that are watched now
  std::optional<PathBatch> batch;  // none: paths are followed one by one
};

// What the queued order has of its own; outlives passes and snapshots, and so do paths under way.
struct RenderSession::Queues {
  QueuedPaths paths;
  SampleSequence sequence;
  SampleOrder order;
};

std::optional<double> RenderProgress::seconds_left() const {
  const double done = double(samples_done - samples_before), all = double(samples_total) - double(samples_before);
  if (done >= all || done < 0.01 * all) return std::nullopt;
  return elapsed_s * (all / done - 1);
}

RenderSession::RenderSession(const Scene& scene, SessionOptions options)
    : scene_(scene),
      options_(std::move(options)),
      camera_(scene),
      film_(visible_window(scene.settings, options_.crop), camera_.mean_weight(), film_aovs(scene.settings)),
      tiles_(tiles_along_hilbert_curve(film_.window(), options_.tile_side)),
      pass_ends_(pass_ends(std::uint32_t(scene.settings.samples), scene.settings.noise > 0)),
      threads_(options_.threads > 0 ? options_.threads : default_thread_count()),
      order_(possible_order(scene)) {}

RenderSession::~RenderSession() = default;

std::vector<std::uint32_t> RenderSession::pass_ends(std::uint32_t samples, bool adaptive) {
  std::vector<std::uint32_t> ends;
  for (std::uint32_t end = 1; end < samples; end *= adaptive && end >= noise::first_decision ? 2 : 4)
    ends.push_back(end);
  ends.push_back(samples);
  return ends;
}

void RenderSession::resume(Film film, AdaptiveState adaptive) {
  CHECK(film.window() == film_.window() && film.aovs() == film_.aovs(), "a film of other pixels or AOVs");
  film_ = std::move(film);
  adaptive_ = std::move(adaptive);
}

SessionResult RenderSession::render() {
  CHECK(started_s_ == 0, "render() is called once");
  started_s_ = last_report_s_ = process_age_s();
  samples_before_ = film_.total_samples();
  samples_done_ = samples_before_;
  samples_total_ = samples_to_take();
  std::vector<RayCounts> rays(std::size_t(threads_), RayCounts{});
  for (const std::uint32_t end : pass_ends_) {
    if (ended()) break;
    ++pass_number_;
    run_pass(end, rays);
    while (pausing_.exchange(false)) {
      options_.snapshot();
      if (!ended()) run_pass(end, rays);
    }
    if (!ended()) choose_finished(end);
  }
  SessionResult result;
  for (const RayCounts& r : rays) result.rays += r;
  result.samples = film_.total_samples();
  result.render_s = process_age_s() - started_s_;
  if (first_pixel_s_ >= 0) result.first_pixel_s = first_pixel_s_;
  if (queues_) result.queues = queues_->paths.statistics();
  queues_.reset();
  if (result.samples < samples_total_) result.end = cancelled() ? RenderEnd::Cancelled : RenderEnd::TimeLimit;
  send_progress(process_age_s());
  return result;
}

void RenderSession::run_pass(std::uint32_t end, std::vector<RayCounts>& rays) {
  if (order_ != RayOrder::Queued) run_tiles(end, rays);
  if (thrashes_.exchange(false)) order_ = RayOrder::Queued;
  if (order_ == RayOrder::Queued && !stopped()) run_queues(end, rays);
}

// Passes end at the decisions of adaptive sampling alone: else a queue would run empty at each.
void RenderSession::run_queues(std::uint32_t end, std::vector<RayCounts>& rays) {
  scene_.intersector->unsettle();
  const RenderSettings& settings = scene_.settings;
  if (!queues_) {
    queues_.reset(new Queues{{scene_, camera_, path_wants(), settings.queue_bytes},
                             {film_, tiles_, options_.first_sample},
                             {film_, options_.first_sample}});
  }
  queues_->sequence.extend(settings.noise > 0 ? end : pass_ends_.back(), adaptive_.finished);
  queues_->paths.run(threads_,
                     {[this](PixelSample& next) { return queues_->sequence.next(next); },
                      [this](const PixelSample& at, const FilmSample& s) { note_added(queues_->order.add(at, s)); },
                      [this] { return queues_->sequence.bytes() + queues_->order.bytes(); },
                      [this] { return stopped(); }, [this] { look_around(); }},
                     rays);
}

// Where nothing has settled yet, few pixels far apart expand most of what all will meet. That settles, and what the
// others expand is little.
void RenderSession::run_tiles(std::uint32_t end, std::vector<RayCounts>& rays) {
  do {
    scene_.intersector->settle();
    if (pass_number_ == 1 && !scene_.intersector->is_settled()) {
      trace_tiles(end, sparse_step, rays);
      if (!stopped()) scene_.intersector->settle();
    }
    if (!stopped()) trace_tiles(end, 1, rays);
  } while (crowded_.exchange(false) && !stopped());
}

void RenderSession::trace_tiles(std::uint32_t end, int step, std::vector<RayCounts>& rays) {
  next_tile_ = 0;
  const bool together = scene_.integrator->stepper() && scene_.intersector->is_settled();
  run_threads(threads_, [&](int thread) {
    Worker worker{thread, end, step, scene_.sampler->clone(), {}, scene_.intersector->thread_expansions(), {}};
    if (together) worker.batch.emplace(scene_, camera_, path_wants());
    try {
      for (std::size_t i = next_tile_++; i < tiles_.size() && !stopped(); i = next_tile_++)
        render_tile(worker, tiles_[step > 1 ? apart(i, tiles_.size(), std::size_t(threads_)) : i]);
    } catch (...) {
      failed_ = true;
      throw;
    }
    rays[std::size_t(thread)] += worker.rays;
  });
}

// Looks at the last cells that the thread's rays asked for.
bool RenderSession::goes_on_to_queues(Worker& worker) const {
  // At 150 us an expansion and 1.5 us a cell a tenth of the time
  constexpr std::uint64_t watched_cells = 1 << 12, most_reexpanded = 4;
  const ThreadExpansions now = scene_.intersector->thread_expansions();
  if (now.reexpanded - worker.watched.reexpanded > most_reexpanded) return true;
  if (now.acquired - worker.watched.acquired >= watched_cells) worker.watched = now;
  return false;
}

void RenderSession::render_tile(Worker& worker, const PixelWindow& tile) {
  const auto first = [&](int from) { return (from + worker.step - 1) / worker.step * worker.step; };
  for (int y = first(tile.y0); y < tile.y1; y += worker.step)
    for (int x = first(tile.x0); x < tile.x1; x += worker.step) {
      if (stopped()) return;
      if (!is_finished(x, y)) worker.batch ? add_pixel(worker, x, y) : render_pixel(worker, x, y);
      if (order_ == RayOrder::Auto && goes_on_to_queues(worker)) thrashes_ = true;
      if (worker.thread == 0) look_around();
    }
  if (worker.batch) finish_batch(worker);
}

void RenderSession::add_pixel(Worker& worker, int x, int y) {
  for (std::uint32_t sample = film_.samples(x, y); sample < worker.pass_end; ++sample) {
    worker.batch->add({x, y, options_.first_sample + sample});
    if (worker.batch->is_full()) finish_batch(worker);
  }
}

void RenderSession::finish_batch(Worker& worker) {
  std::uint32_t added = 0;
  worker.batch->finish(*worker.sampler, worker.rays, [&](const PixelSample& at, const FilmSample& sample) {
    film_.add(at.x, at.y, sample);
    ++added;
  });
  note_added(added);
}

void RenderSession::render_pixel(Worker& worker, int x, int y) {
  const std::uint32_t first = film_.samples(x, y);
  std::uint32_t sample = first;
  for (; sample < worker.pass_end && !stopped(); ++sample) take_sample(worker, {x, y, options_.first_sample + sample});
  note_added(sample - first);
}

void RenderSession::note_added(std::uint32_t samples) {
  if (samples > 0 && samples_done_.fetch_add(samples, std::memory_order_relaxed) == samples_before_)
    first_pixel_s_ = process_age_s();
}

void RenderSession::take_sample(Worker& worker, const PixelSample& at) {
  Sampler& sampler = *worker.sampler;
  const CameraPaths::Start start = camera_.start(at, sampler);
  FilmSample result{.weight = start.weight, .number = at.number};
  const std::uint64_t escaped_before = worker.rays.escaped;
  std::optional<FirstSurface> first;
  if (film_.wants_first_surface()) {
    first.emplace();
    first->time = start.ray.time;
    result.first = &*first;
  }
  FirstSurface* const wanted = first ? &*first : nullptr;
  if (film_.wants_costs())
    measure_sample(worker, start.ray, wanted, result);
  else
    result.radiance = scene_.integrator->radiance(start.ray, scene_, sampler, worker.rays, wanted);
  result.covered = worker.rays.escaped == escaped_before;
  camera_.measure(result);
  film_.add(at.x, at.y, result);
}

void RenderSession::measure_sample(Worker& worker, const Ray& ray, FirstSurface* first, FilmSample& sample) {
  const auto started = std::chrono::steady_clock::now();
  const ThreadExpansions before = scene_.intersector->thread_expansions();
  sample.radiance = scene_.integrator->radiance(ray, scene_, *worker.sampler, worker.rays, first);
  sample.expansions = scene_.intersector->thread_expansions() - before;
  sample.nanoseconds = std::uint64_t(std::chrono::nanoseconds(std::chrono::steady_clock::now() - started).count());
}

void RenderSession::choose_finished(std::uint32_t end) {
  if (scene_.settings.noise <= 0 || !noise::is_decision(end) || end <= adaptive_.decided_at) return;
  noise::choose_finished(film_, end, scene_.settings.noise, adaptive_);
  samples_total_ = samples_to_take();
}

bool RenderSession::is_finished(int x, int y) const {
  const PixelWindow& w = film_.window();
  return !adaptive_.finished.empty() &&
         adaptive_.finished[std::size_t(y - w.y0) * std::size_t(w.width()) + std::size_t(x - w.x0)];
}

// That the film will hold as far as is known now.
std::uint64_t RenderSession::samples_to_take() const {
  const PixelWindow& w = film_.window();
  const auto wanted = std::uint32_t(scene_.settings.samples);
  std::uint64_t total = 0;
  for (int y = w.y0; y < w.y1; ++y)
    for (int x = w.x0; x < w.x1; ++x)
      total += is_finished(x, y) ? film_.samples(x, y) : std::max(film_.samples(x, y), wanted);
  return total;
}

void RenderSession::look_around() {
  const double now = process_age_s();
  if (now - last_report_s_ < report_interval_s) return;
  send_progress(now);
  if (now - started_s_ >= options_.time_limit_s) out_of_time_ = true;
  if (options_.snapshot_due && options_.snapshot_due()) pausing_ = true;
  if (scene_.intersector->is_crowded()) crowded_ = true;
}

void RenderSession::send_progress(double now) {
  last_report_s_ = now;
  if (!options_.progress) return;
  options_.progress({samples_done_.load(std::memory_order_relaxed), samples_total_, pass_number_,
                     int(pass_ends_.size()), now - started_s_, samples_before_});
}

bool RenderSession::cancelled() const { return options_.cancel && options_.cancel->load(std::memory_order_relaxed); }

bool RenderSession::stopped() const {
  return failed_.load(std::memory_order_relaxed) || pausing_.load(std::memory_order_relaxed) ||
         thrashes_.load(std::memory_order_relaxed) || crowded_.load(std::memory_order_relaxed) || ended();
}

}  // namespace meristem
