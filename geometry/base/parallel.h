// Threads. The one place that includes TBB (in parallel.cpp); everything else calls these functions.
#pragma once

#include <cstddef>
#include <functional>

namespace meristem {

// The number of threads to use when the user does not say: those this process may run on.
int default_thread_count();

// Limits all TBB work of the process (Embree's builds among it) to n threads while it lives. One at a time, in main.
class ThreadLimit {
 public:
  explicit ThreadLimit(int n);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  void* control_;
};

// Runs work(thread_index) on n threads of their own (std::thread; thread 0 is the caller) and joins them. Denormals are
// flushed on each. The first exception thrown is rethrown after all have ended.
void run_threads(int n, const std::function<void(int thread_index)>& work);

// Runs body(i) for i in [0, count) on TBB; the order is unspecified. Exceptions propagate.
void parallel_for(std::size_t count, const std::function<void(std::size_t i)>& body);

// The same for a caller that holds a lock: while it waits it takes up nothing else, which might ask for that lock.
void parallel_for_under_lock(std::size_t count, const std::function<void(std::size_t i)>& body);

// Runs f in a TBB arena that holds the calling thread alone: what f commits to Embree is built by this thread, and no
// outer task is picked up while it waits. Safe to nest under a ray (a thread never waits for another here).
void run_isolated(const std::function<void()>& f);

// Flushes denormals to zero on the calling thread (MXCSR FTZ and DAZ): hits depend on it, so every thread that expands
// or traces calls it.
void flush_denormals();

}  // namespace meristem
