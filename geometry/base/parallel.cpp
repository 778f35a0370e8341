#include "geometry/base/parallel.h"

#include <pmmintrin.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <xmmintrin.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace meristem {

#ifdef MERISTEM_TSAN
namespace {

// Debian's TBB is not instrumented: its workers' synchronization is not seen, and all they do for Embree looks like
// races. Without them Embree's builds run on our threads.
const tbb::global_control no_workers(tbb::global_control::max_allowed_parallelism, 1);

}  // namespace

int default_thread_count() { return int(std::max(1u, std::thread::hardware_concurrency())); }
#else
int default_thread_count() {
  return int(std::thread::hardware_concurrency() ? tbb::this_task_arena::max_concurrency() : 1);
}
#endif

ThreadLimit::ThreadLimit(int n)
    : control_(new tbb::global_control(tbb::global_control::max_allowed_parallelism, std::size_t(n))) {}

ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(control_); }

void run_threads(int n, const std::function<void(int)>& work) {
  std::exception_ptr first;
  std::mutex mutex;
  auto guarded = [&](int index) {
    flush_denormals();
    try {
      work(index);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!first) first = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> threads;
    for (int i = 1; i < n; ++i) threads.emplace_back(guarded, i);
    guarded(0);
  }
  if (first) std::rethrow_exception(first);
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
#ifdef MERISTEM_TSAN
  std::atomic<std::size_t> next{0};
  run_threads(default_thread_count(), [&](int) {
    for (std::size_t i; (i = next.fetch_add(1)) < count;) body(i);
  });
#else
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t i) {
    flush_denormals();
    body(i);
  });
#endif
}

void parallel_for_under_lock(std::size_t count, const std::function<void(std::size_t)>& body) {
#ifdef MERISTEM_TSAN
  parallel_for(count, body);
#else
  tbb::this_task_arena::isolate([&] { parallel_for(count, body); });
#endif
}

void run_isolated(const std::function<void()>& f) {
  thread_local tbb::task_arena arena(1);
  arena.execute(f);
}

void flush_denormals() {
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
}

}  // namespace meristem
