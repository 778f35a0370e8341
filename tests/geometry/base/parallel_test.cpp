#include "geometry/base/parallel.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace meristem {
namespace {

// Whether a thread that waits for an inner loop has taken up another turn of the outer one meanwhile: it would have
// asked for the lock that it holds. Turns are uneven, so that some threads run out of work and take up that of others.
template <class InnerLoop>
bool asks_again(const InnerLoop& inner_loop) {
  thread_local bool holds_lock = false;
  std::atomic<bool> result{false};
  for (int round = 0; round < 30; ++round)
    parallel_for(24, [&](std::size_t i) {
      if (holds_lock) result = true;
      holds_lock = true;
      inner_loop(8,
                 [&](std::size_t k) { std::this_thread::sleep_for(std::chrono::microseconds(100 * ((i + k) % 5))); });
      holds_lock = false;
    });
  return result;
}

// With more threads than there may be cores: two alone never come to that.
TEST(Parallel, WhoWaitsUnderALockTakesUpNothingThatMightAskForIt) {
  constexpr int threads = 8;
  const ThreadLimit limit(threads);
  tbb::task_arena arena(threads);
  EXPECT_FALSE(arena.execute([] { return asks_again(parallel_for_under_lock); }));
}

}  // namespace
}  // namespace meristem
