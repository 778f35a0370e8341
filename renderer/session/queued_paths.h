// QueuedPaths: the queued order of rays. Many paths are alive at once; a path goes on as far as resident cells take it
// and then waits for the cells that its rays need first and that are not resident. When no more paths may
// begin, the cell for which most of them wait is expanded, serves all of these, and each goes on until it waits again.
// So with a small geometry cache a cell is expanded once for hundreds of rays, where paths followed one by one would
// expand it for each.
//
// How many paths are alive is limited by memory, which is counted: states, searches, queues, and what whoever takes the
// samples keeps of those that came before their turn. The queues are shared by
// all threads: a thread claims a part of the longest, works without any lock, and comes back with what waits now. A
// thread that finds nothing to claim sleeps until another comes back.
//
// A path draws the same random numbers and ends with the same bits as one that is followed at once. In which order
// samples are delivered is not determined.
#pragma once

#include "renderer/session/camera_paths.h"
#include "renderer/session/waiting_queues.h"

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>

namespace meristem {

struct FilmSample;

struct QueueStatistics {
  std::uint64_t waits = 0;   // times that a path began to wait
  std::uint64_t served = 0;  // times that a queue was served
  std::uint64_t paths_peak = 0, bytes_peak = 0;
};

class QueuedPaths {
 public:
  // The scene's integrator has a stepper. All must outlive it.
  QueuedPaths(const Scene& scene, const CameraPaths& camera, PathWants wants, std::size_t most_bytes);
  ~QueuedPaths();

  struct Exchange {
    std::function<bool(PixelSample&)> next;                              // false: there is no more
    std::function<void(const PixelSample&, const FilmSample&)> deliver;  // of each of these two one call at a time
    std::function<std::size_t()> bytes;                                  // kept by these two; with next()
    std::function<bool()> stopped;                                       // any thread, often
    std::function<void()> look_around;                                   // by thread 0, often
  };
  // Until all samples have been delivered, or it is stopped. Then paths under way stay for the next call.
  void run(int threads, const Exchange& exchange, std::vector<RayCounts>& rays);

  QueueStatistics statistics() const;

 private:
  struct Slot;
  struct Wait;
  struct Cost;
  struct Chunk;
  struct Worker;
  class Meter;

  void work(Worker& worker);
  bool claim(Worker& worker);
  void hand_back(Worker& worker);
  void begin_paths(Worker& worker);
  bool has_room(const Exchange& exchange);
  std::size_t bytes(const Exchange& exchange) const;
  void follow(Worker& worker, std::uint32_t id);
  bool go_on(std::uint32_t id, const PathTools& tools);
  bool meets_light(std::uint32_t id, const PathTools& tools);
  RaySearch::End search(const RayRequest& request, RaySearch& search, SurfaceHit& hit) const;
  void deliver(Worker& worker);
  FilmSample film_sample(std::uint32_t id);
  void prefetch(std::uint32_t id);
  Slot& slot(std::uint32_t id);
  void* state(std::uint32_t id);

  const Scene& scene_;
  const PathStepper& stepper_;
  const CameraPaths& camera_;
  const PathWants wants_;
  const std::size_t most_bytes_, state_words_;

  std::atomic<std::size_t> search_bytes_{0};
  std::mutex delivery_;

  mutable std::mutex mutex_;  // guards what follows; chunks do not move, and a path is of the thread that claimed it
  std::condition_variable changed_;
  std::vector<std::unique_ptr<Chunk>> chunks_;
  std::vector<std::uint32_t> free_;
  WaitingQueues queues_;
  std::size_t alive_ = 0;
  int working_ = 0;         // threads that may come back with paths that wait
  int sleeping_ = 0;        // threads that wait for these
  bool exhausted_ = false;  // no more samples
  bool failed_ = false;     // a worker threw
  QueueStatistics statistics_;
};

}  // namespace meristem
