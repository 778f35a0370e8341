// RenderSession: renders a Scene into a Film with N threads.
//
// The samples of all pixels are taken in passes: sample 0 of every pixel, then samples 1 to 3, 4 to 15, and so on, each
// pass up to the next power of four. So a whole image stands early, and the few passes cost a small geometry cache
// little. Within a pass, threads take tiles along a Hilbert curve from a counter; a pixel goes on from the samples it
// has. So a pass may end at any sample and begin anew, for a snapshot of the film in between or in another process. The
// image has the same bits for any number of threads, any size of tiles and any interruptions, since a pixel's samples
// are counted off by (pixel, sample, seed) and summed exactly.
//
// That is the depth-first order. In the queued order (queued_paths.h) many paths are alive at once, passes overlap, and
// samples come back as they like; they enter the film in their order all the same. With RayOrder::Auto a render begins
// depth-first and goes over to queues when more than a thousandth of the cells that rays ask for have to be expanded
// again; it does not go back. Integrators whose paths cannot be stopped stay depth-first.
//
// With RenderSettings::noise, passes double from 16 samples on, and after each the pixels that are finished are chosen
// (film/noise.h).
//
// Owns the film, borrows the scene. Used by one thread; that thread renders too and calls the functions of the options.
#pragma once

#include "renderer/film/film.h"
#include "renderer/film/film_file.h"
#include "renderer/scene/scene.h"
#include "renderer/session/camera_paths.h"
#include "renderer/session/queued_paths.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace meristem {

struct RenderProgress {
  std::uint64_t samples_done = 0, samples_total = 0;
  int pass = 0, passes = 0;          // from 1
  double elapsed_s = 0;              // since render() began
  std::uint64_t samples_before = 0;  // of those done: taken before render() began, by the run that it carries on

  double fraction() const { return samples_total ? double(samples_done) / double(samples_total) : 0; }
  // Nothing while it would be a guess.
  std::optional<double> seconds_left() const;
};

struct SessionOptions {
  int threads = 0;                                                // 0: default_thread_count()
  int tile_side = 16;                                             // pixels
  std::optional<PixelWindow> crop = {};                           // of the full frame; cut to it
  std::uint32_t first_sample = 0;                                 // RenderSettings::samples count from it
  double time_limit_s = std::numeric_limits<double>::infinity();  // of render()
  const std::atomic<bool>* cancel = nullptr;                      // set it, and render() ends within a sample a thread
  std::function<void(const RenderProgress&)> progress = {};       // called about ten times a second, and at the end
  std::function<bool()> snapshot_due = {};                        // asked as often
  std::function<void()> snapshot = {};                            // called when it was due: no thread touches the film
};

// Why render() ended.
enum class RenderEnd : std::uint8_t { Complete, TimeLimit, Cancelled };

struct SessionResult {
  RayCounts rays;
  std::uint64_t samples = 0;  // that the film holds
  double render_s = 0;
  std::optional<double> first_pixel_s;  // since the process began: when the first pixel had its first sample
  RenderEnd end = RenderEnd::Complete;
  std::optional<QueueStatistics> queues;  // if rays were queued
};

class RenderSession {
 public:
  // The crop must meet the frame.
  RenderSession(const Scene& scene, SessionOptions options);
  ~RenderSession();

  // Goes on from a film of the same scene and options; before render().
  void resume(Film film, AdaptiveState adaptive);

  // Once. When it does not end complete, pixels have different numbers of samples; the film is a whole image once the
  // first pass is done. Rethrows what an integrator throws.
  SessionResult render();
  const Film& film() const { return film_; }
  const AdaptiveState& adaptive() const { return adaptive_; }

 private:
  struct Worker;
  struct Queues;
  static std::vector<std::uint32_t> pass_ends(std::uint32_t samples, bool adaptive);

  PathWants path_wants() const { return {film_.wants_first_surface(), film_.wants_costs()}; }
  void run_pass(std::uint32_t end, std::vector<RayCounts>& rays);
  void run_tiles(std::uint32_t end, std::vector<RayCounts>& rays);
  // Every `step`-th pixel in x and y.
  void trace_tiles(std::uint32_t end, int step, std::vector<RayCounts>& rays);
  void run_queues(std::uint32_t end, std::vector<RayCounts>& rays);
  bool goes_on_to_queues(Worker& worker) const;
  void note_added(std::uint32_t samples);
  void render_tile(Worker& worker, const PixelWindow& tile);
  void render_pixel(Worker& worker, int x, int y);
  void add_pixel(Worker& worker, int x, int y);
  void finish_batch(Worker& worker);
  void take_sample(Worker& worker, const PixelSample& at);
  void measure_sample(Worker& worker, const Ray& ray, FirstSurface* first, FilmSample& sample);
  void choose_finished(std::uint32_t end);
  std::uint64_t samples_to_take() const;
  bool is_finished(int x, int y) const;
  void look_around();  // progress, time and snapshots, if it is time for them
  void send_progress(double now);
  bool ended() const { return cancelled() || out_of_time_.load(std::memory_order_relaxed); }
  bool cancelled() const;
  bool stopped() const;

  const Scene& scene_;
  SessionOptions options_;
  CameraPaths camera_;
  Film film_;
  AdaptiveState adaptive_;
  std::vector<PixelWindow> tiles_;
  std::vector<std::uint32_t> pass_ends_;  // each the number of samples that a pixel has after it
  int threads_;
  RayOrder order_;
  std::unique_ptr<Queues> queues_;  // once rays are queued

  // Of the calling thread.
  int pass_number_ = 0;
  double started_s_ = 0, last_report_s_ = 0;
  std::uint64_t samples_before_ = 0, samples_total_ = 0;

  // Of all threads.
  std::atomic<std::size_t> next_tile_{0};
  std::atomic<std::uint64_t> samples_done_{0};
  std::atomic<double> first_pixel_s_{-1};
  std::atomic<bool> failed_{false};  // a worker threw: the others stop
  std::atomic<bool> out_of_time_{false};
  std::atomic<bool> pausing_{false};   // for a snapshot
  std::atomic<bool> thrashes_{false};  // RayOrder::Auto: time for queues
  std::atomic<bool> crowded_{false};   // time to let go of what settled
};

}  // namespace meristem
