// RenderSession: renders a Scene into a Film with N threads.
//
// The samples of all pixels are taken in passes: sample 0 of every pixel, then samples 1 to 3, 4 to 15, and so on, each
// pass up to the next power of four. So a whole image stands early, and the few passes cost a small geometry cache
// little. Within a pass, threads take tiles along a Hilbert curve from a counter. The image has the same bits for any
// number of threads and any size of tiles, since a pixel's samples are counted off by (pixel, sample, seed) and summed
// in order.
//
// Owns the film, borrows the scene. Used by one thread; that thread renders too and calls the progress function.
#pragma once

#include "renderer/film/film.h"
#include "renderer/film/filter_sampler.h"
#include "renderer/scene/scene.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace meristem {

struct RenderProgress {
  std::uint64_t samples_done = 0, samples_total = 0;
  int pass = 0, passes = 0;  // from 1
  double elapsed_s = 0;      // since render() began

  double fraction() const { return samples_total ? double(samples_done) / double(samples_total) : 0; }
};

struct SessionOptions {
  int threads = 0;                                           // 0: default_thread_count()
  int tile_side = 16;                                        // pixels
  std::optional<PixelWindow> crop = {};                      // of the full frame; cut to it
  const std::atomic<bool>* cancel = nullptr;                 // set it, and render() ends within a sample a thread
  std::function<void(const RenderProgress&)> progress = {};  // called about ten times a second, and at the end
};

struct SessionResult {
  RayCounts rays;
  std::uint64_t samples = 0;  // taken
  double render_s = 0;
  std::optional<double> first_pixel_s;  // since the process began: when the first pixel had its first sample
  bool cancelled = false;
};

class RenderSession {
 public:
  // The crop must meet the frame.
  RenderSession(const Scene& scene, SessionOptions options);

  // Once. When cancelled, pixels have different numbers of samples; the film is a whole image once the first pass is
  // done. Rethrows what an integrator throws.
  SessionResult render();
  const Film& film() const { return film_; }

 private:
  struct Worker;
  struct Pass {
    int first_sample, last_sample;  // [first, last)
  };
  static std::vector<Pass> passes_for(int samples);

  void run_pass(const Pass& pass, std::vector<RayCounts>& rays);
  void render_tile(Worker& worker, const PixelWindow& tile);
  void render_pixel(Worker& worker, int x, int y);
  void take_sample(Worker& worker, int x, int y, int sample);
  void report_progress();  // if it is time
  void send_progress(double now);
  bool stopped() const;

  const Scene& scene_;
  SessionOptions options_;
  FilterSampler filter_;
  Film film_;
  std::vector<PixelWindow> tiles_;
  std::vector<Pass> passes_;
  int threads_;

  // Of the calling thread.
  int pass_number_ = 0;
  double started_s_ = 0, last_report_s_ = 0;

  // Of all threads.
  std::atomic<std::size_t> next_tile_{0};
  std::atomic<std::uint64_t> samples_done_{0};
  std::atomic<double> first_pixel_s_{-1};
  std::atomic<bool> failed_{false};  // a worker threw: the others stop
};

}  // namespace meristem
