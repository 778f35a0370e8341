#include "renderer/session/session.h"

#include "geometry/base/check.h"
#include "geometry/base/parallel.h"
#include "renderer/session/process_clock.h"
#include "renderer/session/tiles.h"

#include <algorithm>

namespace meristem {

namespace {

constexpr double report_interval_s = 0.1;

PixelWindow visible_window(const RenderSettings& settings, const std::optional<PixelWindow>& crop) {
  const PixelWindow frame{0, 0, settings.width, settings.height};
  return crop ? crop->intersected(frame) : frame;
}

}  // namespace

// What one thread has of its own during a pass.
struct RenderSession::Worker {
  int thread;
  Pass pass;
  std::unique_ptr<Sampler> sampler;
  RayCounts rays;
};

RenderSession::RenderSession(const Scene& scene, SessionOptions options)
    : scene_(scene),
      options_(std::move(options)),
      filter_(*scene.filter),
      film_(visible_window(scene.settings, options_.crop), filter_.mean_weight()),
      tiles_(tiles_along_hilbert_curve(film_.window(), options_.tile_side)),
      passes_(passes_for(scene.settings.samples)),
      threads_(options_.threads > 0 ? options_.threads : default_thread_count()) {}

std::vector<RenderSession::Pass> RenderSession::passes_for(int samples) {
  std::vector<Pass> passes;
  for (int first = 0; first < samples;) {
    const int last = first == 0 ? 1 : first > samples / 4 ? samples : first * 4;
    passes.push_back({first, std::min(last, samples)});
    first = last;
  }
  return passes;
}

SessionResult RenderSession::render() {
  CHECK(started_s_ == 0, "render() is called once");
  started_s_ = last_report_s_ = process_age_s();
  std::vector<RayCounts> rays(std::size_t(threads_), RayCounts{});
  for (const Pass& pass : passes_) {
    if (stopped()) break;
    ++pass_number_;
    run_pass(pass, rays);
  }
  SessionResult result;
  result.cancelled = stopped();
  for (const RayCounts& r : rays) result.rays += r;
  result.samples = film_.total_samples();
  result.render_s = process_age_s() - started_s_;
  if (first_pixel_s_ >= 0) result.first_pixel_s = first_pixel_s_;
  send_progress(process_age_s());
  return result;
}

void RenderSession::run_pass(const Pass& pass, std::vector<RayCounts>& rays) {
  next_tile_ = 0;
  run_threads(threads_, [&](int thread) {
    Worker worker{thread, pass, scene_.sampler->clone(), {}};
    try {
      for (std::size_t i = next_tile_++; i < tiles_.size() && !stopped(); i = next_tile_++)
        render_tile(worker, tiles_[i]);
    } catch (...) {
      failed_ = true;
      throw;
    }
    rays[std::size_t(thread)] += worker.rays;
  });
}

void RenderSession::render_tile(Worker& worker, const PixelWindow& tile) {
  for (int y = tile.y0; y < tile.y1; ++y)
    for (int x = tile.x0; x < tile.x1; ++x) {
      if (stopped()) return;
      render_pixel(worker, x, y);
      if (worker.thread == 0) report_progress();
    }
}

void RenderSession::render_pixel(Worker& worker, int x, int y) {
  int sample = worker.pass.first_sample;
  for (; sample < worker.pass.last_sample && !stopped(); ++sample) take_sample(worker, x, y, sample);
  const std::uint64_t taken = std::uint64_t(sample - worker.pass.first_sample);
  if (taken > 0 && samples_done_.fetch_add(taken, std::memory_order_relaxed) == 0) first_pixel_s_ = process_age_s();
}

void RenderSession::take_sample(Worker& worker, int x, int y, int sample) {
  const RenderSettings& settings = scene_.settings;
  Sampler& sampler = *worker.sampler;
  sampler.start(x, y, sample, settings.seed);
  // Choose where in the filter's support the ray passes, and where on the lens
  const FilterSample at = filter_.sample(sampler.next_2d());
  const CameraSample camera_sample{Vec2f{float(x) + 0.5f, float(y) + 0.5f} + at.offset, sampler.next_2d()};
  const Ray ray = scene_.camera->ray(camera_sample, settings.width, settings.height);
  const std::uint64_t escaped_before = worker.rays.escaped;
  const Spectrum radiance = scene_.integrator->radiance(ray, scene_, sampler, worker.rays);
  film_.add(x, y, radiance, worker.rays.escaped == escaped_before, at.weight);
  scene_.intersector->quiescent();
}

void RenderSession::report_progress() {
  const double now = process_age_s();
  if (now - last_report_s_ >= report_interval_s) send_progress(now);
}

void RenderSession::send_progress(double now) {
  last_report_s_ = now;
  if (!options_.progress) return;
  const std::uint64_t pixels = std::uint64_t(film_.window().width()) * std::uint64_t(film_.window().height());
  options_.progress({samples_done_.load(std::memory_order_relaxed), pixels * std::uint64_t(scene_.settings.samples),
                     pass_number_, int(passes_.size()), now - started_s_});
}

bool RenderSession::stopped() const {
  return failed_.load(std::memory_order_relaxed) ||
         (options_.cancel && options_.cancel->load(std::memory_order_relaxed));
}

}  // namespace meristem
